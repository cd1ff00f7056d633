//! Robust weights, and the choice of curvature weight and harmonic by cross-validation.

use super::least_squares::{LeastSquares, Model, Solution};
use crate::numerics::robust::Loss;
use crate::numerics::statistics::{SIGMA_PER_MAD, median_absolute_deviation};

/// Curvature weights tried: 10^(k/2) from 1e-9 to 1e2. The lowest follows a kink from one position to the next, the
/// highest leaves a power law.
const EXPONENTS: std::ops::RangeInclusive<i32> = -18..=4;
/// Parts into which the positions are divided, every fifth into the same.
const FOLDS: usize = 5;
/// Iterations with Huber's monotone weights, then with Tukey's.
const START_ITERATIONS: usize = 10;
const ITERATIONS: usize = 60;
/// Residuals below this share are rounding of f32 amplitudes, not scatter.
const ROUNDING: f64 = 1e-6;
/// Rounds of choosing the model with the weights of the last one.
const ROUNDS: usize = 4;

/// A robust fit.
#[derive(Clone, Debug)]
pub(super) struct Robust {
    pub(super) model: Model,
    pub(super) solution: Solution,
    /// Robust weight of each point, 0..=1.
    pub(super) weights: Vec<f64>,
}

/// The robust fit with the model that predicts positions best that are left out. With `with_harmonic`, the harmonic
/// is used where it predicts better than the spline alone.
pub(super) fn best(rows: &LeastSquares, with_harmonic: bool) -> Option<Robust> {
    let middle = Model { curvature_weight: 1e-5, harmonic: with_harmonic };
    let mut fit = reweighted(rows, middle, &vec![1.0; rows.len()])?;
    for _ in 0..ROUNDS {
        let model = choose(rows, with_harmonic, &fit.weights)?;
        let settled = model == fit.model;
        fit = reweighted(rows, model, &vec![1.0; rows.len()])?;
        if settled {
            break;
        }
    }
    Some(fit)
}

/// Iteratively reweighted least squares of the points whose prior weight is above 0: Huber's weights (1964,
/// k = 1.345) until they settle, then Tukey's biweight (c = 4.685 σ, σ = 1.4826 MAD of the residuals).
pub(super) fn reweighted(rows: &LeastSquares, model: Model, prior: &[f64]) -> Option<Robust> {
    let mut weights = prior.to_vec();
    let mut last = rows.normal(weights.clone())?.solve(model)?;
    for iteration in 0..ITERATIONS {
        let mut entered: Vec<f64> = last
            .residuals
            .iter()
            .zip(prior)
            .filter(|(r, p)| **p > 0.0 && r.is_finite())
            .map(|(r, _)| *r)
            .collect();
        let sigma = (SIGMA_PER_MAD * median_absolute_deviation(&mut entered)?).max(ROUNDING);
        for ((weight, residual), prior) in weights.iter_mut().zip(&last.residuals).zip(prior) {
            // A decay that was rejected as a whole has no level and stays out.
            let robust = if residual.is_finite() {
                Loss::Tukey.weight(residual / sigma, iteration < START_ITERATIONS)
            } else {
                0.0
            };
            *weight = prior * robust;
        }
        let next = rows.normal(weights.clone())?.solve(model)?;
        let moved = next.residuals.iter().zip(&last.residuals).map(|(a, b)| (a - b).abs());
        let moved = moved.filter(|change| change.is_finite()).fold(0.0, f64::max);
        last = next;
        if iteration >= START_ITERATIONS && moved <= 1e-6 * sigma {
            break;
        }
    }
    Some(Robust { model, solution: last, weights })
}

/// The model with the least weighted squared error on inner positions that are left out in turn; of equals, the
/// smoother one without the harmonic.
fn choose(rows: &LeastSquares, with_harmonic: bool, weights: &[f64]) -> Option<Model> {
    let weights_tried = EXPONENTS.rev().map(|exponent| 10f64.powf(0.5 * f64::from(exponent)));
    let harmonics = [false, true].into_iter().take(if with_harmonic { 2 } else { 1 });
    let models: Vec<Model> = harmonics
        .flat_map(|harmonic| {
            weights_tried.clone().map(move |curvature_weight| Model { curvature_weight, harmonic })
        })
        .collect();
    let mut errors = vec![0.0; models.len()];
    for fold in 0..FOLDS {
        let held_out = |row: usize| rows.position[row] % FOLDS == fold;
        // The outermost positions are never predicted: that would be extrapolation.
        let inner = |row: usize| (1..rows.positions.saturating_sub(1)).contains(&rows.position[row]);
        let training = |(row, weight): (usize, &f64)| if held_out(row) && inner(row) { 0.0 } else { *weight };
        let Some(normal) = rows.normal(weights.iter().enumerate().map(training).collect()) else { continue };
        for (model, error) in models.iter().zip(&mut errors) {
            let Some(solution) = normal.solve(*model) else {
                *error = f64::INFINITY;
                continue;
            };
            // A decay without a point in the training has no level.
            let tested = (0..rows.len()).filter(|&row| held_out(row) && inner(row));
            let squares = tested.map(|row| weights[row] * solution.residuals[row].powi(2));
            *error += squares.filter(|square| square.is_finite()).sum::<f64>();
        }
    }
    let least = models.into_iter().zip(errors).filter(|(_, error)| error.is_finite());
    least.reduce(|best, next| if next.1 < best.1 { next } else { best }).map(|(model, _)| model)
}
