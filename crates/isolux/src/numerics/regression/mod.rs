//! Robust linear regression with intercepts per group and errors that may be shared within clusters.
//!
//! The model is `y_i = α_g(i) + Σ_k β_k x_ik + ε_i`. The intercepts α of the groups (one material, one pixel) are
//! eliminated, not solved for: there may be as many as there are pixels. ε may be correlated within a cluster
//! (neighbouring pixels, one frame); the intervals allow for that.

mod cluster;
mod rank;
mod solve;
#[cfg(test)]
mod tests;

use nalgebra::{DMatrix, DVector};
use serde::Serialize;

use crate::numerics::robust::Loss;
use crate::numerics::statistics::{SIGMA_PER_MAD, median_absolute_deviation};
use cluster::Clusters;
use solve::{Centred, Solution};

/// Iterations with Huber's monotone weights, which find the neighbourhood of the solution from anywhere.
const START_ITERATIONS: usize = 20;
/// Most iterations altogether.
const ITERATIONS: usize = 120;
/// Coefficients that move by less than this share of their standard error (of independent errors) have settled.
const SETTLED: f64 = 1e-6;

/// Rows of one regression. Every row has a value for each column, a response, a weight, a group and, for each
/// way in which errors may be shared, a cluster.
#[derive(Clone, Debug)]
pub(crate) struct Regression {
    columns: Vec<String>,
    intercepts: Intercepts,
    design: Vec<f64>,
    response: Vec<f64>,
    weights: Vec<f64>,
    groups: Vec<u32>,
    clusters: Vec<Vec<u32>>,
}

/// Which constants the model has besides its columns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Intercepts {
    /// None: the response is 0 where all columns are.
    None,
    /// One for each group.
    PerGroup,
}

/// One row of a regression.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Row<'a> {
    /// A value for each column.
    pub columns: &'a [f64],
    /// The value to be explained.
    pub response: f64,
    /// Prior weight, ≥ 0; proportional to 1/σ².
    pub weight: f64,
    /// Which intercept.
    pub group: u32,
    /// Which cluster, for each way in which errors may be shared; empty for independent errors.
    pub clusters: &'a [u32],
}

/// Why a regression has no solution.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub(crate) enum RegressionError {
    /// A row does not fit the columns, or holds a number that is not finite.
    #[error("row {row}: {columns} finite numbers, a finite response and a weight ≥ 0 expected")]
    Row {
        /// Number of the row, from 0.
        row: usize,
        /// Number of columns.
        columns: usize,
    },
    /// There are fewer rows than unknowns.
    #[error("{found} rows for {unknowns} unknowns")]
    TooFewRows {
        /// Rows with a positive weight.
        found: usize,
        /// Columns and intercepts.
        unknowns: usize,
    },
    /// A column is the same in every row of a group.
    #[error("`{column}` does not vary")]
    Constant {
        /// The column.
        column: String,
    },
    /// A column follows from others.
    #[error("`{column}` varies only together with {}", others.join(" and "))]
    Dependent {
        /// The column.
        column: String,
        /// The columns that it follows from.
        others: Vec<String>,
    },
    /// Intervals need several clusters.
    #[error("{found} clusters, at least {needed} needed to tell how far the result can be trusted")]
    TooFewClusters {
        /// Clusters found, in the way that has fewest.
        found: usize,
        /// Clusters needed.
        needed: usize,
    },
}

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
    /// Share of the column's variance (within groups) that the other columns do not explain, 0..=1: near 0, the
    /// column can hardly be told from the others.
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
    /// A regression on the named columns, without rows yet.
    #[must_use]
    pub(crate) fn new(columns: impl IntoIterator<Item = impl Into<String>>, intercepts: Intercepts) -> Self {
        Self {
            columns: columns.into_iter().map(Into::into).collect(),
            intercepts,
            design: Vec::new(),
            response: Vec::new(),
            weights: Vec::new(),
            groups: Vec::new(),
            clusters: Vec::new(),
        }
    }

    /// Adds a row. All rows name their clusters in the same ways, as the first row does.
    ///
    /// # Errors
    /// [`RegressionError::Row`] for a wrong number of values or clusters, or a number that is not finite.
    pub(crate) fn push(&mut self, row: Row<'_>) -> Result<(), RegressionError> {
        let number = self.response.len();
        if number == 0 {
            self.clusters = vec![Vec::new(); row.clusters.len()];
        }
        let finite = row.columns.iter().chain([&row.response, &row.weight]).all(|value| value.is_finite());
        let fits = row.columns.len() == self.columns.len() && row.clusters.len() == self.clusters.len();
        if !finite || !fits || row.weight < 0.0 {
            return Err(RegressionError::Row { row: number, columns: self.columns.len() });
        }
        self.design.extend_from_slice(row.columns);
        self.response.push(row.response);
        self.weights.push(row.weight);
        self.groups.push(row.group);
        self.clusters.iter_mut().zip(row.clusters).for_each(|(way, &cluster)| way.push(cluster));
        Ok(())
    }

    /// Number of rows.
    #[must_use]
    pub(crate) fn rows(&self) -> usize {
        self.response.len()
    }

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
        let centred = self.centre(&prior);
        let (condition, tolerances) = rank::check(&self.columns, &self.design, &centred, &prior)?;
        // Residuals shrink by what the unknowns absorb.
        let freedom = (rows as f64 / (rows - unknowns) as f64).sqrt();
        let solution = self.iterate(loss, &prior, freedom)?;
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
        Ok(self.report(coefficients, covariance, condition, freedom, &entering, solution))
    }

    fn report(
        &self,
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

    /// Rows with a weight, in groups of more than one such row: a row alone only determines its intercept.
    fn entering(&self) -> Vec<bool> {
        let weighted = |row: usize| self.weights[row] > 0.0;
        if self.intercepts == Intercepts::None {
            return (0..self.rows()).map(weighted).collect();
        }
        let mut counts = std::collections::HashMap::new();
        (0..self.rows()).filter(|&row| weighted(row)).for_each(|row| {
            *counts.entry(self.groups[row]).or_insert(0usize) += 1;
        });
        (0..self.rows())
            .map(|row| weighted(row) && counts.get(&self.groups[row]).is_some_and(|&n| n > 1))
            .collect()
    }

    fn group_count(&self, entering: &[bool]) -> usize {
        let entered = self.groups.iter().zip(entering).filter(|(_, enters)| **enters).map(|(group, _)| group);
        match self.intercepts {
            Intercepts::None => 0,
            Intercepts::PerGroup => entered.collect::<std::collections::HashSet<_>>().len(),
        }
    }
}
