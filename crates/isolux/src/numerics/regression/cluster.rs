//! Errors that neighbours share.

use std::collections::BTreeMap;

use nalgebra::{DMatrix, DVector};

use super::error::RegressionError;
use super::solve::Solution;

/// Clusters below which a variance between them is no estimate.
const MINIMUM_CLUSTERS: usize = 3;

/// Clusters of the rows that enter, for each way in which errors may be shared.
pub(super) struct Clusters {
    /// For each way the number of its clusters and, for each row, its cluster.
    ways: Vec<(usize, Vec<usize>)>,
}

impl Clusters {
    /// Without any way, every row is its own cluster.
    pub(super) fn new(ways: &[Vec<u32>], entering: &[bool]) -> Result<Self, RegressionError> {
        let alone = (entering.len(), (0..entering.len()).collect());
        let ways: Vec<_> = match ways {
            [] => vec![alone],
            ways => ways.iter().map(|way| number(way, entering)).collect(),
        };
        let found = ways.iter().map(|(count, _)| *count).min().unwrap_or(0);
        if found < MINIMUM_CLUSTERS {
            return Err(RegressionError::TooFewClusters { found, needed: MINIMUM_CLUSTERS });
        }
        Ok(Self { ways })
    }

    /// Sandwich covariance, the sum over the ways.
    pub(super) fn covariance(&self, solution: &Solution, prior: &[f64], columns: usize) -> DMatrix<f64> {
        let Solution { centred, residuals, robust, sigma, loss, .. } = solution;
        let slopes: Vec<f64> =
            residuals.iter().zip(prior).map(|(r, prior)| prior * loss.derivative(r / sigma)).collect();
        let weights: Vec<f64> = prior.iter().zip(robust).map(|(prior, robust)| prior * robust).collect();
        // Far from normal errors the derivative's sum may lose its sign; the weights' never does.
        let bread = centred.gram(&slopes).cholesky().or_else(|| centred.gram(&weights).cholesky());
        let Some(bread) = bread.map(|factor| factor.inverse()) else {
            return DMatrix::from_element(columns, columns, f64::INFINITY);
        };
        let mut meat = DMatrix::zeros(columns, columns);
        for (count, cluster) in &self.ways {
            let mut scores = vec![DVector::<f64>::zeros(columns); *count];
            for (row, &weight) in weights.iter().enumerate().filter(|(_, weight)| **weight > 0.0) {
                let score = &mut scores[cluster[row]];
                centred
                    .row(row)
                    .iter()
                    .enumerate()
                    .for_each(|(k, x)| score[k] += weight * residuals[row] * x);
            }
            let factor = *count as f64 / (*count - 1) as f64;
            scores.iter().for_each(|score| meat += factor * score * score.transpose());
        }
        &bread * meat * &bread
    }

    /// 97.5 % quantile of Student's t with one degree of freedom less than clusters; from three degrees on,
    /// expansion 26.7.5 of Abramowitz and Stegun, within 1 %.
    pub(super) fn student_t_975(&self) -> f64 {
        let clusters = self.ways.iter().map(|(count, _)| *count).min().unwrap_or(MINIMUM_CLUSTERS);
        if clusters <= MINIMUM_CLUSTERS {
            return 4.302_652_729_749_46;
        }
        let nu = (clusters - 1) as f64;
        let z = crate::numerics::statistics::Z_95;
        z + (z.powi(3) + z) / (4.0 * nu)
            + (5.0 * z.powi(5) + 16.0 * z.powi(3) + 3.0 * z) / (96.0 * nu.powi(2))
            + (3.0 * z.powi(7) + 19.0 * z.powi(5) + 17.0 * z.powi(3) - 15.0 * z) / (384.0 * nu.powi(3))
    }
}

/// Numbers the clusters of the entering rows from 0.
fn number(way: &[u32], entering: &[bool]) -> (usize, Vec<usize>) {
    let mut numbers = BTreeMap::new();
    for (&cluster, _) in way.iter().zip(entering).filter(|(_, enters)| **enters) {
        let next = numbers.len();
        numbers.entry(cluster).or_insert(next);
    }
    (numbers.len(), way.iter().map(|cluster| numbers.get(cluster).copied().unwrap_or(0)).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn students_t_is_that_of_the_tables() {
        for (clusters, expected) in [(3, 4.303), (4, 3.182), (5, 2.776), (11, 2.228), (61, 2.000)] {
            let found = Clusters { ways: vec![(clusters, Vec::new())] }.student_t_975();
            assert!((found / expected - 1.0f64).abs() < 0.01, "{found} {expected}");
        }
    }
}
