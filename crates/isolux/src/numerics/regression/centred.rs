//! Columns and response without the intercepts.

use nalgebra::{DMatrix, DVector};

use super::rows::{Intercepts, Regression};

/// Columns and response less their weighted means within groups.
pub(super) struct Centred {
    pub(super) columns: usize,
    pub(super) design: Vec<f64>,
    pub(super) response: Vec<f64>,
}

impl Centred {
    /// Takes the weighted mean of each group out; that of the prior weights where the weights leave nothing.
    pub(super) fn of(regression: &Regression, weights: &[f64]) -> Self {
        let columns = regression.columns.len();
        let mut centred =
            Self { columns, design: regression.design.clone(), response: regression.response.clone() };
        if regression.intercepts == Intercepts::None {
            return centred;
        }
        let mut means: std::collections::HashMap<u32, (f64, Vec<f64>)> = std::collections::HashMap::new();
        for (row, &weight) in weights.iter().enumerate() {
            // A tiny share of the prior weight keeps groups defined in which every row was rejected.
            let weight = weight + 1e-12 * regression.weights[row];
            let (total, sums) =
                means.entry(regression.groups[row]).or_insert_with(|| (0.0, vec![0.0; columns + 1]));
            *total += weight;
            let values = centred.row(row).iter().chain([&regression.response[row]]);
            sums.iter_mut().zip(values).for_each(|(sum, value)| *sum += weight * value);
        }
        for row in 0..regression.rows() {
            let Some((total, sums)) = means.get(&regression.groups[row]).filter(|(total, _)| *total > 0.0)
            else {
                continue;
            };
            let x = &mut centred.design[row * columns..(row + 1) * columns];
            x.iter_mut().zip(sums).for_each(|(x, sum)| *x -= sum / total);
            centred.response[row] -= sums[columns] / total;
        }
        centred
    }

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
    pub(super) fn moment(&self, weights: &[f64]) -> DVector<f64> {
        let mut moment = DVector::zeros(self.columns);
        for (row, &weight) in weights.iter().enumerate() {
            for (k, x) in self.row(row).iter().enumerate() {
                moment[k] += weight * x * self.response[row];
            }
        }
        moment
    }

    pub(super) fn residuals(&self, beta: &DVector<f64>) -> Vec<f64> {
        let predicted = |row: usize| self.row(row).iter().zip(beta.iter()).map(|(x, b)| x * b).sum::<f64>();
        self.response.iter().enumerate().map(|(row, y)| y - predicted(row)).collect()
    }
}
