//! The iteration.

use nalgebra::DVector;

use super::centred::Centred;
use super::error::RegressionError;
use super::rank;
use super::rows::Regression;
use crate::numerics::robust::Loss;
use crate::numerics::statistics::{SIGMA_PER_MAD, median_absolute_deviation};

/// Iterations with Huber's monotone weights, which find the neighbourhood of the solution from anywhere.
const START_ITERATIONS: usize = 20;
/// Most iterations altogether.
const ITERATIONS: usize = 120;
/// Coefficients that move by less than this share of their standard error (of independent errors) have settled.
const SETTLED: f64 = 1e-6;

/// Where the iteration ended.
pub(super) struct Solution {
    pub(super) beta: DVector<f64>,
    pub(super) centred: Centred,
    pub(super) residuals: Vec<f64>,
    /// Robust weights, 0..=1, without the prior ones.
    pub(super) robust: Vec<f64>,
    pub(super) sigma: f64,
    pub(super) loss: Loss,
}

pub(super) fn iterate(
    regression: &Regression,
    loss: Loss,
    prior: &[f64],
    freedom: f64,
) -> Result<Solution, RegressionError> {
    let mut robust = vec![1.0; regression.rows()];
    let mut previous: Option<DVector<f64>> = None;
    let mut iteration = 0;
    loop {
        let weights: Vec<f64> = prior.iter().zip(&robust).map(|(prior, robust)| prior * robust).collect();
        let centred = Centred::of(regression, &weights);
        let gram = centred.gram(&weights);
        let factor = gram.clone().cholesky().ok_or_else(|| rejected_away(regression, &centred, prior))?;
        let beta = factor.solve(&centred.moment(&weights));
        let residuals = centred.residuals(&beta);
        let sigma = freedom * scale(&residuals, prior, &regression.response);
        let settled = previous.is_some_and(|previous| {
            (0..beta.len()).all(|k| (beta[k] - previous[k]).abs() <= SETTLED * sigma / gram[(k, k)].sqrt())
        });
        let starting = iteration < START_ITERATIONS;
        let done = loss == Loss::LeastSquares || (!starting && settled) || iteration >= ITERATIONS;
        if done {
            return Ok(Solution { beta, centred, residuals, robust, sigma, loss });
        }
        for (robust, residual) in robust.iter_mut().zip(&residuals) {
            *robust = loss.weight(residual / sigma, starting && !settled);
        }
        // Settled with Huber's weights: no need to wait for the last of the starting iterations.
        iteration = if starting && settled { START_ITERATIONS } else { iteration + 1 };
        previous = Some(beta);
    }
}

/// Names the column that the rejection of outliers has left without variation.
fn rejected_away(regression: &Regression, centred: &Centred, prior: &[f64]) -> RegressionError {
    match rank::check(&regression.columns, &regression.design, centred, prior) {
        Err(error) => error,
        Ok(_) => RegressionError::Constant { column: regression.columns.join(", ") },
    }
}

/// 1.4826 MAD of the residuals, kept above rounding: an exact relation must not divide by 0.
fn scale(residuals: &[f64], prior: &[f64], response: &[f64]) -> f64 {
    let mut entered: Vec<f64> = residuals
        .iter()
        .zip(prior)
        .filter(|(_, prior)| **prior > 0.0)
        .map(|(residual, _)| *residual)
        .collect();
    let size = response.iter().fold(1e-300f64, |size, y| size.max(y.abs()));
    (SIGMA_PER_MAD * median_absolute_deviation(&mut entered).unwrap_or(0.0)).max(1e-12 * size)
}
