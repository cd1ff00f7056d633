//! Fits a [`Spline`] to reference decays.
//!
//! No position is corrected by the table over integration time. The table multiplies each decay by one number,
//! which the decay's level absorbs: the fit is the same with and without it. The saturation that the table contains
//! (S(t) t / t_ref) is that of its own sweep, at one amplitude per time, not that of the positions of this target.
//! Saturated positions are outliers to the other integration times, at which the same distance is not saturated.

use super::error::LEAST_POSITIONS;
use super::least_squares::{LeastSquares, Model, count_positions};
use super::select::{Robust, best, reweighted};
use super::{Harmonic, Law, Spline, SplineError};
use crate::numerics::bspline::Basis;
use crate::numerics::statistics::{SIGMA_PER_MAD, median};
use crate::terms::cubic::{Decay, Scaling};
use crate::terms::{FitQuality, root_mean_square};

/// Equal intervals of ln d between the outermost positions; the curvature weight makes it smooth, not their number.
const INTERVALS: usize = 24;

/// How the fit used one reference decay.
#[derive(Clone, Debug, PartialEq)]
pub struct SplineUse {
    /// Integration time of the decay, µs.
    pub integration_time_us: Option<f64>,
    /// Whether it covers the reference distance, is placed by the others, or is left out.
    pub scaling: Scaling,
    /// Root mean square of the relative error that the law leaves on the positions that have a weight.
    pub residual: Option<f64>,
    /// Typical relative error (1.4826 times the median) on those positions where the law was fitted without them: to the
    /// other decays or, with one decay, to the other positions. No root mean square: without this decay, the law may
    /// follow saturated positions of the others at an end.
    pub held_out_error: Option<f64>,
    /// Positions without a weight: outliers to the others.
    pub outliers: usize,
}

impl Spline {
    /// Positions that a spline needs; with fewer it would follow the noise of each.
    pub const LEAST_POSITIONS: usize = LEAST_POSITIONS;

    /// Fits the law to reference decays of any number of integration times; says for each how it was used.
    ///
    /// Every decay has a level of its own, so that one that does not reach the reference distance is placed by its
    /// overlap with the others; one without any is left out. Robust: Tukey's biweight, c = 4.685 σ, σ = 1.4826 MAD.
    /// The curvature weight is chosen from 10^(k/2), 1e-9 to 1e2, by five-fold cross-validation over positions,
    /// and so is whether the harmonic is used, when `modulation_frequency_hz` is known. Held-out residual: each
    /// decay predicted from the others but for its level or, with one decay, each inner position from the rest.
    ///
    /// # Errors
    /// [`SplineError`] when the positions are too few, none covers the reference, or the law is impossible.
    pub fn fit(
        decays: &[Decay],
        reference_m: f64,
        modulation_frequency_hz: Option<f64>,
    ) -> Result<(Self, Vec<SplineUse>), SplineError> {
        let (used, range) = connected(decays, reference_m)?;
        let chosen: Vec<&Decay> = used.iter().map(|&index| &decays[index]).collect();
        let distances: Vec<f64> = chosen.iter().flat_map(|d| d.points.iter().map(|p| p.distance_m)).collect();
        let found = count_positions(&distances);
        if found < Self::LEAST_POSITIONS {
            return Err(SplineError::TooFewPositions { found });
        }
        let basis = Basis::new(range[0].ln(), range[1].ln(), INTERVALS);
        let frequency_hz = modulation_frequency_hz.filter(|f| *f > 0.0 && f.is_finite());
        let rows = LeastSquares::new(&chosen, basis, reference_m, frequency_hz);
        let robust = best(&rows, frequency_hz.is_some()).ok_or(SplineError::Undetermined)?;
        let law = in_gauge(&robust, basis, reference_m, range, frequency_hz);
        let relative = |row: usize| robust.solution.residuals[row].exp_m1();
        let unseen = held_out(&rows, robust.model, &robust.weights);
        let fit = FitQuality {
            points: rows.len(),
            residual: root_mean_square((0..rows.len()).map(relative).filter(|r| r.is_finite()))
                .unwrap_or(0.0),
            held_out_residual: root_mean_square(unseen.iter().map(|&(_, error)| error)),
        };
        let (version, fitted_on, warnings) = (Self::VERSION, Vec::new(), Vec::new());
        let spline = Self { version, law, fitted_on, fit, warnings };
        spline.check().map_err(|error| SplineError::Impossible { found: error.to_string() })?;
        let report = |(index, decay): (usize, &Decay)| {
            let number = used.iter().position(|&used| used == index);
            let points = || (0..rows.len()).filter(|&row| Some(rows.decay[row]) == number);
            let kept = points().filter(|&row| robust.weights[row] > 0.0);
            let of_kept = unseen
                .iter()
                .filter(|(row, _)| Some(rows.decay[*row]) == number && robust.weights[*row] > 0.0);
            let covers = covers(decay, reference_m);
            SplineUse {
                integration_time_us: decay.integration_time_us,
                scaling: match number {
                    None => Scaling::LeftOut,
                    Some(_) if covers => Scaling::AtReference,
                    Some(_) => Scaling::OntoOthers,
                },
                residual: root_mean_square(kept.map(relative)),
                held_out_error: typical(of_kept.map(|&(_, error)| error.abs())),
                outliers: points().filter(|&row| robust.weights[row] == 0.0).count(),
            }
        };
        let uses = decays.iter().enumerate().map(report).collect();
        Ok((spline, uses))
    }
}

/// The law that was found. B-splines sum to 1, so a constant added to all adds it to ln h: it is 0 at the reference.
fn in_gauge(
    robust: &Robust,
    basis: Basis,
    reference_distance_m: f64,
    valid_distance_m: [f64; 2],
    frequency_hz: Option<f64>,
) -> Law {
    let found = &robust.solution.coefficients;
    let harmonic = frequency_hz.filter(|_| robust.model.harmonic).map(|modulation_frequency_hz| Harmonic {
        modulation_frequency_hz,
        cosine: found[basis.len()],
        sine: found[basis.len() + 1],
    });
    let mut law = Law {
        reference_distance_m,
        valid_distance_m,
        coefficients: found[..basis.len()].to_vec(),
        harmonic,
        curvature_weight: robust.model.curvature_weight,
    };
    let at_reference = law.ln_response(reference_distance_m);
    law.coefficients.iter_mut().for_each(|c| *c -= at_reference);
    law
}

fn range_of(decay: &Decay) -> [f64; 2] {
    let distances = decay.points.iter().map(|point| point.distance_m);
    distances.fold([f64::INFINITY, f64::NEG_INFINITY], |[min, max], d| [min.min(d), max.max(d)])
}

fn covers(decay: &Decay, reference_m: f64) -> bool {
    let [min_m, max_m] = range_of(decay);
    (min_m..=max_m).contains(&reference_m)
}

/// The decays that overlap, directly or through others, one that covers the reference, and the range of all of
/// them. A single point only determines the level of its decay, and values without a logarithm are not used.
fn connected(decays: &[Decay], reference_m: f64) -> Result<(Vec<usize>, [f64; 2]), SplineError> {
    let usable = |decay: &Decay| {
        let fine = |x: f64| x > 0.0 && x.is_finite();
        decay.points.len() >= 2 && decay.points.iter().all(|p| fine(p.distance_m) && fine(p.amplitude_dn))
    };
    let candidates: Vec<usize> = (0..decays.len()).filter(|&index| usable(&decays[index])).collect();
    if candidates.is_empty() {
        return Err(SplineError::TooFewPositions { found: 0 });
    }
    let anchored = candidates.iter().copied().filter(|&index| covers(&decays[index], reference_m));
    let mut used: Vec<usize> = anchored.collect();
    if used.is_empty() {
        return Err(SplineError::ReferenceOutside { reference_m });
    }
    let whole = |used: &[usize]| {
        let ranges = used.iter().map(|&index| range_of(&decays[index]));
        ranges.fold([f64::INFINITY, f64::NEG_INFINITY], |[min, max], [a, b]| [min.min(a), max.max(b)])
    };
    loop {
        let [min_m, max_m] = whole(&used);
        let overlaps = |index: &usize| {
            let [near_m, far_m] = range_of(&decays[*index]);
            !used.contains(index) && near_m <= max_m && far_m >= min_m
        };
        match candidates.iter().copied().find(overlaps) {
            Some(index) => used.push(index),
            None => {
                used.sort_unstable();
                let range = whole(&used);
                return Ok((used, range));
            }
        }
    }
}

/// What the standard deviation of a normal distribution would be.
fn typical(errors: impl Iterator<Item = f64>) -> Option<f64> {
    median(&mut errors.collect::<Vec<_>>()).map(|median| SIGMA_PER_MAD * median)
}

/// Relative errors on points that the fit has not seen, each with its row.
fn held_out(rows: &LeastSquares, model: Model, weights: &[f64]) -> Vec<(usize, f64)> {
    let groups = if rows.decays >= 2 { rows.decays } else { rows.positions };
    let group = |row: usize| if rows.decays >= 2 { rows.decay[row] } else { rows.position[row] };
    let mut errors = Vec::new();
    for left_out in 0..groups {
        if rows.decays < 2 && (left_out == 0 || left_out + 1 == groups) {
            continue;
        }
        let prior =
            (0..rows.len()).map(|row| f64::from(u8::from(group(row) != left_out))).collect::<Vec<_>>();
        let Some(fit) = reweighted(rows, model, &prior) else { continue };
        let tested =
            (0..rows.len()).filter(|&row| group(row) == left_out && rows.is_inside(row, &fit.weights));
        if rows.decays < 2 {
            errors.extend(tested.map(|row| (row, fit.solution.residuals[row].exp_m1())));
            continue;
        }
        let found: Vec<(usize, f64)> = tested.map(|row| (row, rows.error(row, &fit.solution))).collect();
        // The level of a decay is its own: that of its majority.
        let trusted = found.iter().filter(|(row, _)| weights[*row] > 0.0);
        let Some(level) = median(&mut trusted.map(|(_, error)| *error).collect::<Vec<_>>()) else {
            continue;
        };
        errors.extend(found.into_iter().map(|(row, error)| (row, (error - level).exp_m1())));
    }
    errors
}
