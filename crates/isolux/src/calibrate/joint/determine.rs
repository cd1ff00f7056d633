//! How well the observations determine each factor.
//!
//! Three questions are asked about each factor. They are about its curve (ln h at 33 distances, ln v in the
//! observed cells of the image, s at every time, the effect of k at 60°), not about its coefficients:
//! - What would its standard error be if all other factors were known and all errors independent? If it is too large,
//!   the factor was not observed.
//! - By what factor does the error grow because the others are unknown too (the square root of the variance
//!   inflation)? If it grows too much, the factor is confounded with them, and small errors of the model would grow
//!   as much.
//! - How much do ln d and ln cosθ vary beyond what the other factors explain? Both are measured with errors of a
//!   few percent. If they vary by little more than these errors, the fitted slope is too small.
//!
//! The standard errors that are reported account for errors that the observations of a frame share.

use std::ops::Range;

use nalgebra::{DMatrix, DVector};

use super::columns::{Columns, Row};
use super::factor::Factor;
use super::finding::Finding;
use super::problem::Problem;
use super::refusal::Refusal;
use super::robust::{Robust, factorize};
use super::shared_errors;
use crate::terms::profile::Places;

/// How well the observations determine the factors.
pub(super) struct Found {
    /// On every factor that was fitted, but the exposures of frames, which nobody asks for.
    pub(super) findings: Vec<Finding>,
    /// Standard error of ln v in each cell that was seen.
    pub(super) cell_errors: Vec<Option<f64>>,
    /// How far the law falls; `None` without a law.
    pub(super) fall: Option<Fall>,
}

/// What the law does from near to far, beside its slope of −2: whether it is determined or refused.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Fall {
    /// Exponent of the distance, beside −2.
    pub exponent: f64,
    /// Its standard error.
    pub standard_error: f64,
}

/// The findings on all factors.
pub(super) fn findings(problem: &Problem, robust: &Robust) -> Found {
    let columns = &problem.columns;
    let seen = seen_cells(problem, &robust.weights);
    let knowledge = Knowledge::new(problem, robust);
    let fitted: Vec<Factor> =
        Factor::ALL.into_iter().filter(|&factor| !ranges(columns, factor).is_empty()).collect();
    let wanted = fitted.iter().filter(|factor| **factor != Factor::Exposure);
    let findings = wanted.map(|&factor| knowledge.finding(factor, &fitted, &seen)).collect();
    Found { findings, cell_errors: knowledge.cell_errors(&seen), fall: knowledge.fall() }
}

fn system(columns: &Columns, robust: &Robust) -> DMatrix<f64> {
    &robust.normal.gram + columns.prior() * (robust.sigma * robust.sigma)
}

/// Covariance of all coefficients; of independent errors where the frames are too few to tell what they share.
fn covariance(problem: &Problem, robust: &Robust) -> Option<DMatrix<f64>> {
    let independent = || {
        let factor = factorize(&robust.normal.gram, &problem.columns.prior(), robust.sigma)?;
        Some(factor.inverse() * (robust.sigma * robust.sigma))
    };
    shared_errors::covariance(problem, robust).or_else(independent)
}

/// Columns of a factor.
fn ranges(columns: &Columns, factor: Factor) -> Vec<usize> {
    let both = |a: &Range<usize>, b: &Range<usize>| a.clone().chain(b.clone()).collect();
    match factor {
        Factor::Time | Factor::Exposure => {
            let of_frames = columns.model.time.is_some_and(|time| time.of_frames);
            let mine = of_frames == (factor == Factor::Exposure);
            columns.times.clone().filter(|_| mine).collect()
        }
        Factor::Distance => both(&columns.law, &columns.harmonic),
        Factor::Profile => both(&columns.radial, &columns.tensor),
        Factor::Angle => columns.angle.clone().collect(),
    }
}

fn seen_cells(problem: &Problem, weights: &[f64]) -> Vec<bool> {
    let mut seen = vec![false; Places::CELLS[0] * Places::CELLS[1]];
    if let Some(places) = problem.columns.model.profile {
        for (observation, _) in problem.observations.iter().zip(weights).filter(|(_, w)| **w > 0.0) {
            if let Some(cell) = places.cell(observation.place.map(f64::from)) {
                seen[cell] = true;
            }
        }
    }
    seen
}

pub(super) struct Knowledge<'a> {
    pub(super) columns: &'a Columns,
    robust: &'a Robust,
    /// `G + σ² P`.
    system: DMatrix<f64>,
    /// Of all coefficients.
    covariance: Option<DMatrix<f64>>,
}

impl<'a> Knowledge<'a> {
    pub(super) fn new(problem: &'a Problem, robust: &'a Robust) -> Self {
        let columns = &problem.columns;
        Self { columns, robust, system: system(columns, robust), covariance: covariance(problem, robust) }
    }

    fn finding(&self, factor: Factor, fitted: &[Factor], seen: &[bool]) -> Finding {
        let others: Vec<Factor> = fitted.iter().copied().filter(|other| *other != factor).collect();
        let error = |with: &[Factor]| self.error(factor, with, seen);
        let alone = error(&[]);
        let with_others = error(&others);
        let inflation = (with_others / alone).max(1.0);
        let standard_error = root_mean(&self.posterior(&self.functionals(factor, seen)));
        let free_spread = factor.least_spread().map(|_| self.free_spread(factor, &others));
        let narrow = |spread: Option<f64>| {
            factor.least_spread().zip(spread).is_some_and(|(least, spread)| spread < least)
        };
        let narrow_with =
            |with: &[Factor]| narrow(factor.least_spread().map(|_| self.free_spread(factor, with)));
        // NaN (failed arithmetic) counts as too large.
        let too_large = |error: f64| error.is_nan() || error > Finding::LARGEST_ERROR;
        let refusal = if too_large(alone) || narrow_with(&[]) {
            Some(Refusal::NotSeen { factor })
        } else if inflation > Finding::LARGEST_INFLATION || narrow(free_spread) {
            let confounds = |other: &Factor| {
                let pair = std::slice::from_ref(other);
                error(pair) / alone > 0.5 * Finding::LARGEST_INFLATION || narrow_with(pair)
            };
            let guilty: Vec<Factor> = others.iter().copied().filter(confounds).collect();
            let with = if guilty.is_empty() { others } else { guilty };
            Some(Refusal::Confounded { factor, with, inflation })
        } else if too_large(with_others) {
            Some(Refusal::Uncertain { factor, standard_error: with_others })
        } else {
            None
        };
        Finding { factor, standard_error, inflation, free_spread, refusal }
    }

    /// Root mean square standard error of the factor's curve when it and `with` are unknown, of independent errors.
    fn error(&self, factor: Factor, with: &[Factor], seen: &[bool]) -> f64 {
        root_mean(&self.variances(&self.functionals(factor, seen), factor, with))
    }

    /// Variances of linear functions of the coefficients, all factors unknown.
    pub(super) fn posterior(&self, functionals: &[DVector<f64>]) -> Vec<f64> {
        let Some(covariance) = &self.covariance else { return vec![f64::INFINITY] };
        functionals.iter().map(|functional| functional.dot(&(covariance * functional))).collect()
    }

    /// The law from a tenth to nine tenths of the range of ln d: the ends themselves are seen by few.
    fn fall(&self) -> Option<Fall> {
        let ([start, end], _) = self.columns.distance?;
        let [near, far] = [0.1, 0.9].map(|share| start + share * (end - start));
        let at = |ln_distance: f64| dense(self.columns.len, &self.columns.at_distance(ln_distance.exp()));
        let functional = (at(far) - at(near)) / (far - near);
        let variance = self.posterior(std::slice::from_ref(&functional)).first().copied()?;
        Some(Fall { exponent: functional.dot(&self.robust.coefficients), standard_error: variance.sqrt() })
    }

    /// Variances of linear functions of the factor's coefficients.
    fn variances(&self, functionals: &[DVector<f64>], factor: Factor, with: &[Factor]) -> Vec<f64> {
        let mut used = ranges(self.columns, factor);
        used.extend(with.iter().flat_map(|&other| ranges(self.columns, other)));
        used.sort_unstable();
        let part = DMatrix::from_fn(used.len(), used.len(), |i, j| self.system[(used[i], used[j])]);
        let Some(factorized) = part.cholesky() else { return vec![f64::INFINITY] };
        let variance = |functional: &DVector<f64>| {
            let wanted = DVector::from_fn(used.len(), |i, _| functional[used[i]]);
            self.robust.sigma.powi(2) * wanted.dot(&factorized.solve(&wanted))
        };
        functionals.iter().map(variance).collect()
    }

    /// The points of the factor's curve, less that of the gauge.
    pub(super) fn functionals(&self, factor: Factor, seen: &[bool]) -> Vec<DVector<f64>> {
        let columns = self.columns;
        let model = &columns.model;
        let difference = |row: &Row, gauge: &Row| dense(columns.len, row) - dense(columns.len, gauge);
        match factor {
            Factor::Time | Factor::Exposure => {
                let reference = model.time.map_or(0, |time| time.reference);
                let unit = |j: usize| DVector::from_fn(columns.len, |i, _| f64::from(u8::from(i == j)));
                let times = columns.times.clone().filter(|&j| j != reference);
                times.map(|j| unit(j) - unit(reference)).collect()
            }
            Factor::Distance => {
                const STEPS: u32 = 32;
                let (Some(([start, end], _)), Some(law)) = (columns.distance, model.distance) else {
                    return Vec::new();
                };
                let gauge = columns.at_distance(law.reference_m);
                let distances = (0..=STEPS).map(|i| start + (end - start) * f64::from(i) / f64::from(STEPS));
                distances.map(|ln_d| difference(&columns.at_distance(ln_d.exp()), &gauge)).collect()
            }
            Factor::Profile => {
                let Some(places) = model.profile else { return Vec::new() };
                let gauge = columns.at_place([0.0; 2]);
                let cells = (0..seen.len()).filter(|&cell| seen[cell]);
                cells.map(|cell| difference(&columns.at_place(places.cell_centre(cell)), &gauge)).collect()
            }
            Factor::Angle => {
                let effect = |i: usize| if columns.angle.contains(&i) { 0.5f64.ln() } else { 0.0 };
                vec![DVector::from_fn(columns.len, |i, _| effect(i))]
            }
        }
    }

    /// Standard deviation, within surfaces, of that part of ln d or ln cosθ that `others` do not explain.
    fn free_spread(&self, factor: Factor, others: &[Factor]) -> f64 {
        let columns = self.columns;
        let mut direction = DVector::zeros(columns.len);
        match (factor, columns.distance) {
            (Factor::Distance, Some((_, basis))) => {
                direction.rows_mut(columns.law.start, columns.law.len()).copy_from(&basis.line());
            }
            _ => columns.angle.clone().for_each(|column| direction[column] = 1.0),
        }
        let gram = &self.robust.normal.gram;
        let product = gram * &direction;
        let mut variance = direction.dot(&product);
        let used: Vec<usize> = others.iter().flat_map(|&other| ranges(columns, other)).collect();
        let part = DMatrix::from_fn(used.len(), used.len(), |i, j| self.system[(used[i], used[j])]);
        let shared = DVector::from_fn(used.len(), |i, _| product[used[i]]);
        if let Some(factorized) = part.cholesky() {
            variance -= shared.dot(&factorized.solve(&shared));
        }
        (variance.max(0.0) / self.robust.normal.total).sqrt()
    }

    /// Standard error of ln v in each cell that was seen, all factors unknown.
    fn cell_errors(&self, seen: &[bool]) -> Vec<Option<f64>> {
        let mut errors = self.posterior(&self.functionals(Factor::Profile, seen)).into_iter().map(f64::sqrt);
        seen.iter().map(|&seen| if seen { errors.next() } else { None }).collect()
    }
}

/// Root of the mean of variances.
fn root_mean(variances: &[f64]) -> f64 {
    (variances.iter().sum::<f64>() / variances.len().max(1) as f64).sqrt()
}

fn dense(len: usize, row: &Row) -> DVector<f64> {
    let mut dense = DVector::zeros(len);
    row.entries().for_each(|(column, value)| dense[column] += value);
    dense
}
