//! Centring within groups, and the iteration.

use super::*;

/// Columns and response less their weighted means within groups.
pub(super) struct Centred {
    pub(super) columns: usize,
    pub(super) design: Vec<f64>,
    pub(super) response: Vec<f64>,
}

impl Centred {
    pub(super) fn row(&self, row: usize) -> &[f64] {
        &self.design[row * self.columns..(row + 1) * self.columns]
    }

    /// `Σ w x xᵀ`.
    pub(super) fn gram(&self, weights: &[f64]) -> DMatrix<f64> {
        let mut gram = DMatrix::zeros(self.columns, self.columns);
        for (row, &weight) in weights.iter().enumerate().filter(|(_, weight)| **weight != 0.0) {
            let x = self.row(row);
            for i in 0..self.columns {
                for j in 0..=i {
                    gram[(i, j)] += weight * x[i] * x[j];
                }
            }
        }
        gram.fill_upper_triangle_with_lower_triangle();
        gram
    }

    /// `Σ w x y`.
    fn moment(&self, weights: &[f64]) -> DVector<f64> {
        let mut moment = DVector::zeros(self.columns);
        for (row, &weight) in weights.iter().enumerate() {
            for (k, x) in self.row(row).iter().enumerate() {
                moment[k] += weight * x * self.response[row];
            }
        }
        moment
    }

    fn residuals(&self, beta: &DVector<f64>) -> Vec<f64> {
        let predicted = |row: usize| self.row(row).iter().zip(beta.iter()).map(|(x, b)| x * b).sum::<f64>();
        self.response.iter().enumerate().map(|(row, y)| y - predicted(row)).collect()
    }
}

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

impl Regression {
    /// Takes the weighted mean of each group out; that of the prior weights where the weights leave nothing.
    pub(super) fn centre(&self, weights: &[f64]) -> Centred {
        let columns = self.columns.len();
        let mut centred = Centred { columns, design: self.design.clone(), response: self.response.clone() };
        if self.intercepts == Intercepts::None {
            return centred;
        }
        let mut means: std::collections::HashMap<u32, (f64, Vec<f64>)> = std::collections::HashMap::new();
        for (row, &weight) in weights.iter().enumerate() {
            // A tiny share of the prior weight keeps groups defined in which every row was rejected.
            let weight = weight + 1e-12 * self.weights[row];
            let (total, sums) =
                means.entry(self.groups[row]).or_insert_with(|| (0.0, vec![0.0; columns + 1]));
            *total += weight;
            let values = centred.row(row).iter().chain([&self.response[row]]);
            sums.iter_mut().zip(values).for_each(|(sum, value)| *sum += weight * value);
        }
        for row in 0..self.rows() {
            let Some((total, sums)) = means.get(&self.groups[row]).filter(|(total, _)| *total > 0.0) else {
                continue;
            };
            let x = &mut centred.design[row * columns..(row + 1) * columns];
            x.iter_mut().zip(sums).for_each(|(x, sum)| *x -= sum / total);
            centred.response[row] -= sums[columns] / total;
        }
        centred
    }

    pub(super) fn iterate(
        &self,
        loss: Loss,
        prior: &[f64],
        freedom: f64,
    ) -> Result<Solution, RegressionError> {
        let mut robust = vec![1.0; self.rows()];
        let mut previous: Option<DVector<f64>> = None;
        let mut iteration = 0;
        loop {
            let weights: Vec<f64> = prior.iter().zip(&robust).map(|(prior, robust)| prior * robust).collect();
            let centred = self.centre(&weights);
            let gram = centred.gram(&weights);
            let factor = gram.clone().cholesky().ok_or_else(|| self.rejected_away(&centred, prior))?;
            let beta = factor.solve(&centred.moment(&weights));
            let residuals = centred.residuals(&beta);
            let sigma = freedom * scale(&residuals, prior, &self.response);
            let settled = previous.is_some_and(|previous| {
                (0..beta.len())
                    .all(|k| (beta[k] - previous[k]).abs() <= SETTLED * sigma / gram[(k, k)].sqrt())
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
    fn rejected_away(&self, centred: &Centred, prior: &[f64]) -> RegressionError {
        match rank::check(&self.columns, &self.design, centred, prior) {
            Err(error) => error,
            Ok(_) => RegressionError::Constant { column: self.columns.join(", ") },
        }
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
