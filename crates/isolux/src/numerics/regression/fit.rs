//! From rows to coefficients with intervals.

use nalgebra::DMatrix;
use serde::Serialize;

use super::centred::Centred;
use super::cluster::Clusters;
use super::error::RegressionError;
use super::rank;
use super::rows::Regression;
use super::solve::{Solution, iterate};
use crate::numerics::robust::Loss;

/// One fitted coefficient.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct Coefficient {
    /// Name of its column.
    pub column: String,
    /// The estimate, in units of the response per unit of the column.
    pub value: f64,
    /// Its standard error.
    pub standard_error: f64,
    /// Lower end of the 95 % confidence interval.
    pub low_95: f64,
    /// Upper end of the 95 % confidence interval.
    pub high_95: f64,
    /// Share of the column's variance (within groups) that the other columns do not explain, 0..=1. Near 0, its
    /// effect can hardly be separated from theirs.
    pub tolerance: f64,
}

/// A solved regression.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct RegressionFit {
    /// One for each column, in their order.
    pub coefficients: Vec<Coefficient>,
    /// Covariance of the coefficients, in their order.
    pub covariance: DMatrix<f64>,
    /// Robust standard deviation of the residuals, 1.4826 MAD, corrected for the unknowns.
    pub residual_sigma: f64,
    /// Root mean square of all residuals, those of outliers too.
    pub residual_rms: f64,
    /// Residual of each row that entered, in the order of the rows; NaN for rows that did not.
    pub residuals: Vec<f64>,
    /// Rows that entered: those with a positive weight whose group has more than one.
    pub rows: usize,
    /// Share of them whose final weight is above 0.
    pub kept_fraction: f64,
    /// Condition number of the columns (centred, scaled to unit length).
    pub condition: f64,
}

impl RegressionFit {
    /// The coefficient of the column of this name.
    #[must_use]
    pub(crate) fn coefficient(&self, column: &str) -> Option<&Coefficient> {
        self.coefficients.iter().find(|coefficient| coefficient.column == column)
    }
}

impl Regression {
    /// Solves by iteratively reweighted least squares, starting with Huber's weights (1964, k = 1.345), going on
    /// with those of `loss`; the scale is 1.4826 MAD of the residuals. Covariance: sandwich of the estimating
    /// equations, summed by cluster (Liang and Zeger 1986) with the factor G/(G−1); of several ways of clustering
    /// the covariances are added, which is at least that of Cameron, Gelbach and Miller (2011). Intervals use
    /// Student's t with G−1 degrees of freedom, G of the way with fewest clusters.
    ///
    /// # Errors
    /// [`RegressionError`] names the column that cannot be determined, or what there is too little of.
    pub(crate) fn fit(&self, loss: Loss) -> Result<RegressionFit, RegressionError> {
        let entering = self.entering();
        let (rows, groups) = (entering.iter().filter(|&&enters| enters).count(), self.group_count(&entering));
        let unknowns = self.columns.len() + groups;
        if rows <= unknowns || self.columns.is_empty() {
            return Err(RegressionError::TooFewRows { found: rows, unknowns });
        }
        let clusters = Clusters::new(&self.clusters, &entering)?;
        let prior: Vec<f64> =
            self.weights.iter().zip(&entering).map(|(&w, &enters)| if enters { w } else { 0.0 }).collect();
        let centred = Centred::of(self, &prior);
        let (condition, tolerances) = rank::check(&self.columns, &self.design, &centred, &prior)?;
        // Residuals shrink by what the unknowns absorb.
        let freedom = (rows as f64 / (rows - unknowns) as f64).sqrt();
        let solution = iterate(self, loss, &prior, freedom)?;
        let covariance = clusters.covariance(&solution, &prior, self.columns.len());
        let t = clusters.student_t_975();
        let coefficients = (self.columns.iter().zip(tolerances).enumerate())
            .map(|(k, (column, tolerance))| {
                let (value, error) = (solution.beta[k], covariance[(k, k)].max(0.0).sqrt());
                let (low_95, high_95) = (value - t * error, value + t * error);
                Coefficient {
                    column: column.clone(),
                    value,
                    standard_error: error,
                    low_95,
                    high_95,
                    tolerance,
                }
            })
            .collect();
        Ok(report(coefficients, covariance, condition, freedom, &entering, solution))
    }
}

fn report(
    coefficients: Vec<Coefficient>,
    covariance: DMatrix<f64>,
    condition: f64,
    freedom: f64,
    entering: &[bool],
    solution: Solution,
) -> RegressionFit {
    let mut residuals = solution.residuals;
    residuals.iter_mut().zip(entering).filter(|(_, enters)| !**enters).for_each(|(r, _)| *r = f64::NAN);
    let entered = || residuals.iter().filter(|residual| !residual.is_nan());
    let rows = entered().count();
    let squares: f64 = entered().map(|residual| residual * residual).sum();
    let kept = solution.robust.iter().zip(entering).filter(|(w, enters)| **enters && **w > 0.0).count();
    RegressionFit {
        coefficients,
        covariance,
        residual_sigma: solution.sigma,
        residual_rms: (squares / rows as f64).sqrt() * freedom,
        rows,
        kept_fraction: kept as f64 / rows as f64,
        condition,
        residuals,
    }
}
