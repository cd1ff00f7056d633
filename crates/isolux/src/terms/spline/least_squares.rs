//! The weighted, penalized least-squares problem: one level per decay, eliminated; the law's coefficients, solved.

use nalgebra::{DMatrix, DVector};

use super::Harmonic;
use crate::numerics::bspline::Basis;
use crate::terms::cubic::Decay;

/// Neighbouring measured distances of unlike times belong to one position when they are closer than this, relative.
const SAME_POSITION: f64 = 0.01;

/// The points of all decays, in logarithms.
#[derive(Clone, Debug)]
pub(super) struct LeastSquares {
    pub(super) basis: Basis,
    /// Value of each column at each point: the B-splines, then cos 4φ and sin 4φ where f is known.
    design: Vec<f64>,
    columns: usize,
    /// `ln A + 2 ln(d / d_ref)`.
    response: Vec<f64>,
    /// Which decay.
    pub(super) decay: Vec<usize>,
    pub(super) decays: usize,
    /// Number of the position, from the nearest.
    pub(super) position: Vec<usize>,
    pub(super) positions: usize,
    curvature: DMatrix<f64>,
}

/// What is fitted: with which curvature weight, with the harmonic or without.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Model {
    pub(super) curvature_weight: f64,
    pub(super) harmonic: bool,
}

/// A solved problem.
#[derive(Clone, Debug)]
pub(super) struct Solution {
    /// Coefficients of the columns; the first B-spline's is 0, because the levels take up any constant.
    pub(super) coefficients: Vec<f64>,
    /// Response less law less level; NaN in decays without a weight.
    pub(super) residuals: Vec<f64>,
}

/// Gram matrix and moments of weighted rows, from which every curvature weight is solved.
pub(super) struct Normal<'a> {
    rows: &'a LeastSquares,
    weights: Vec<f64>,
    total: f64,
    gram: DMatrix<f64>,
    moment: DVector<f64>,
}

impl LeastSquares {
    pub(super) fn new(
        decays: &[&Decay],
        basis: Basis,
        reference_m: f64,
        modulation_frequency_hz: Option<f64>,
    ) -> Self {
        let columns = basis.len() + if modulation_frequency_hz.is_some() { 2 } else { 0 };
        let mut rows = Self {
            basis,
            design: Vec::new(),
            columns,
            response: Vec::new(),
            decay: Vec::new(),
            decays: decays.len(),
            position: Vec::new(),
            positions: 0,
            curvature: basis.curvature(),
        };
        let mut distances = Vec::new();
        for (number, decay) in decays.iter().enumerate() {
            for point in &decay.points {
                let start = rows.design.len();
                rows.design.resize(start + columns, 0.0);
                let (first, values) = basis.at(point.distance_m.ln());
                rows.design[start + first..start + first + 4].copy_from_slice(&values);
                if let Some(frequency_hz) = modulation_frequency_hz {
                    let harmonic = Harmonic::columns(frequency_hz, point.distance_m);
                    rows.design[start + basis.len()..].copy_from_slice(&harmonic);
                }
                rows.response.push(point.amplitude_dn.ln() + 2.0 * (point.distance_m / reference_m).ln());
                rows.decay.push(number);
                distances.push(point.distance_m);
            }
        }
        rows.position = positions(&distances);
        rows.positions = rows.position.iter().max().map_or(0, |last| last + 1);
        rows
    }

    pub(super) fn len(&self) -> usize {
        self.response.len()
    }

    fn row(&self, row: usize) -> &[f64] {
        &self.design[row * self.columns..(row + 1) * self.columns]
    }

    /// Response less law: the residual of a point, but for its decay's level.
    pub(super) fn error(&self, row: usize, solution: &Solution) -> f64 {
        let law = self.row(row).iter().zip(&solution.coefficients).map(|(x, c)| x * c);
        self.response[row] - law.sum::<f64>()
    }

    /// True when positions with a weight lie on both sides of the row's, or at it.
    pub(super) fn is_inside(&self, row: usize, weights: &[f64]) -> bool {
        let weighted = || self.position.iter().zip(weights).filter(|(_, w)| **w > 0.0).map(|(p, _)| *p);
        let (first, last) = (weighted().min(), weighted().max());
        first.is_some_and(|first| first <= self.position[row])
            && last.is_some_and(|last| last >= self.position[row])
    }

    /// The normal equations of these weights; `None` when all are 0.
    pub(super) fn normal(&self, weights: Vec<f64>) -> Option<Normal<'_>> {
        let total: f64 = weights.iter().sum();
        if !(total > 0.0 && total.is_finite()) {
            return None;
        }
        let (means, _) = self.means(&weights);
        let (mut gram, mut moment) =
            (DMatrix::zeros(self.columns, self.columns), DVector::zeros(self.columns));
        let mut centred = vec![0.0; self.columns];
        for (row, &weight) in weights.iter().enumerate().filter(|(_, weight)| **weight > 0.0) {
            let mean = &means[self.decay[row]];
            centred.iter_mut().zip(self.row(row)).zip(mean).for_each(|((c, x), mean)| *c = x - mean);
            let response = self.response[row] - mean[self.columns];
            for i in 0..self.columns {
                let scaled = weight * centred[i];
                moment[i] += scaled * response;
                for j in 0..=i {
                    gram[(i, j)] += scaled * centred[j];
                }
            }
        }
        gram.fill_upper_triangle_with_lower_triangle();
        Some(Normal { rows: self, weights, total, gram, moment })
    }

    /// Weighted mean of the columns and the response in each decay, and each decay's weight.
    fn means(&self, weights: &[f64]) -> (Vec<Vec<f64>>, Vec<f64>) {
        let mut totals = vec![0.0; self.decays];
        let mut means = vec![vec![0.0; self.columns + 1]; self.decays];
        for (row, &weight) in weights.iter().enumerate() {
            let decay = self.decay[row];
            totals[decay] += weight;
            let values = self.row(row).iter().chain([&self.response[row]]);
            means[decay].iter_mut().zip(values).for_each(|(sum, value)| *sum += weight * value);
        }
        for (mean, total) in means.iter_mut().zip(&totals) {
            mean.iter_mut().for_each(|sum| *sum /= total);
        }
        (means, totals)
    }
}

impl Normal<'_> {
    /// Minimizes `mean(w r²) + curvature_weight ∫ s″²`; `None` when the rows do not determine the columns.
    pub(super) fn solve(&self, model: Model) -> Option<Solution> {
        let rows = self.rows;
        let splines = rows.basis.len();
        let used = if model.harmonic { rows.columns } else { splines };
        let mut system = self.gram.view((1, 1), (used - 1, used - 1)).into_owned();
        let scale = self.total * model.curvature_weight;
        for i in 1..splines {
            for j in 1..splines {
                system[(i - 1, j - 1)] += scale * rows.curvature[(i, j)];
            }
        }
        let factor = system.cholesky()?;
        let solved = factor.solve(&self.moment.rows(1, used - 1).into_owned());
        let mut coefficients = vec![0.0; rows.columns];
        coefficients[1..used].copy_from_slice(solved.as_slice());
        if !coefficients.iter().all(|c| c.is_finite()) {
            return None;
        }
        let (means, _) = rows.means(&self.weights);
        let law = |values: &[f64]| values.iter().zip(&coefficients).map(|(x, c)| x * c).sum::<f64>();
        let level: Vec<f64> = means.iter().map(|mean| mean[rows.columns] - law(mean)).collect();
        let residuals =
            (0..rows.len()).map(|row| rows.response[row] - law(rows.row(row)) - level[rows.decay[row]]);
        let residuals = residuals.collect();
        Some(Solution { coefficients, residuals })
    }
}

/// Numbers the positions from the nearest: distances whose sorted neighbours are closer than 1 % are one.
fn positions(distances_m: &[f64]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..distances_m.len()).collect();
    order.sort_by(|&a, &b| distances_m[a].total_cmp(&distances_m[b]));
    let mut numbers = vec![0; distances_m.len()];
    let mut start_m = order.first().map_or(0.0, |&first| distances_m[first]);
    let mut number = 0;
    for &index in &order {
        if distances_m[index] > start_m * (1.0 + SAME_POSITION) {
            (number, start_m) = (number + 1, distances_m[index]);
        }
        numbers[index] = number;
    }
    numbers
}

/// Number of positions among these distances (m).
pub(super) fn count_positions(distances_m: &[f64]) -> usize {
    positions(distances_m).iter().max().map_or(0, |last| last + 1)
}
