//! Iteratively reweighted least squares.

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

use super::model::JointError;
use super::problem::{Normal, Problem};
use crate::numerics::robust::Loss;
use crate::numerics::statistics::{SIGMA_PER_MAD, median_absolute_deviation};

/// Iterations with Huber's weights, which have one solution, before Tukey's.
const START_ITERATIONS: usize = 6;
const ITERATIONS: usize = 40;
/// Settled when the residuals move by less than this share of σ (root mean square).
const SETTLED: f64 = 1e-3;
/// First estimate of σ, in ln.
const FIRST_SIGMA: f64 = 0.1;
/// Least σ, in ln: observations are f32, and an exact relation must not divide by 0.
const LEAST_SIGMA: f64 = 1e-5;

/// Where the iteration ended.
pub(super) struct Robust {
    pub(super) coefficients: DVector<f64>,
    pub(super) normal: Normal,
    /// Prior and robust weight of each observation together.
    pub(super) weights: Vec<f64>,
    pub(super) residuals: Vec<f64>,
    /// Standard deviation of an observation of weight 1, in ln.
    pub(super) sigma: f64,
}

pub(super) fn solve(problem: &Problem) -> Result<Robust, JointError> {
    let given: Vec<f64> = problem.observations.iter().map(|o| f64::from(o.weight)).collect();
    let prior = problem.columns.prior();
    let (mut weights, mut sigma) = (given.clone(), FIRST_SIGMA);
    let (mut residuals, mut last) = (Vec::new(), Vec::new());
    let mut iteration = 0;
    loop {
        let normal = problem.normal(&weights);
        let factor = factorize(&normal.gram, &prior, sigma);
        let factor = factor.ok_or(JointError::Unsolvable { unknowns: problem.columns.len })?;
        let coefficients = factor.solve(&normal.moment);
        problem.residuals(coefficients.as_slice(), &weights, &mut residuals);
        let settled = has_settled(&residuals, &last, sigma);
        // The weights that gave this solution were Tukey's from here on.
        let biweight = iteration > START_ITERATIONS;
        if (settled && biweight) || iteration >= ITERATIONS {
            return Ok(Robust { coefficients, normal, weights, residuals, sigma });
        }
        // Settled with Huber's weights: no need to wait for the last of the starting iterations.
        if settled {
            iteration = iteration.max(START_ITERATIONS);
        }
        let starting = iteration < START_ITERATIONS;
        sigma = scale(problem, &residuals, &given);
        for ((weight, residual), given) in weights.iter_mut().zip(&residuals).zip(&given) {
            // A surface that was rejected as a whole has no level and does not count.
            let scaled = residual * given.sqrt() / sigma;
            *weight = if scaled.is_finite() { given * Loss::Tukey.weight(scaled, starting) } else { 0.0 };
        }
        iteration += 1;
        last.clone_from(&residuals);
    }
}

/// The posterior's inverse covariance times σ²: `G + σ² P`.
pub(super) fn factorize(gram: &DMatrix<f64>, prior: &DMatrix<f64>, sigma: f64) -> Option<Cholesky<f64, Dyn>> {
    (gram + prior * (sigma * sigma)).cholesky()
}

fn has_settled(residuals: &[f64], last: &[f64], sigma: f64) -> bool {
    let moved =
        residuals.iter().zip(last).map(|(a, b)| (a - b) * (a - b)).filter(|square| square.is_finite());
    let (sum, count) = moved.fold((0.0, 0.0), |(sum, count), square| (sum + square, count + 1.0));
    count > 0.0 && sum <= (SETTLED * sigma).powi(2) * count
}

/// 1.4826 MAD of the residuals at weight 1, corrected for the degrees of freedom of the levels.
fn scale(problem: &Problem, residuals: &[f64], given: &[f64]) -> f64 {
    let mut scaled: Vec<f64> = residuals
        .iter()
        .zip(given)
        .filter(|(_, given)| **given > 0.0)
        .map(|(residual, given)| residual * given.sqrt())
        .filter(|residual| residual.is_finite())
        .collect();
    let (count, levels) = (scaled.len() as f64, problem.surfaces() as f64);
    let freedom = (count / (count - levels - problem.columns.len as f64).max(1.0)).sqrt();
    let deviation = median_absolute_deviation(&mut scaled).unwrap_or(0.0);
    (freedom * SIGMA_PER_MAD * deviation).max(LEAST_SIGMA)
}
