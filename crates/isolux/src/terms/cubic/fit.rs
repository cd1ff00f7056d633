//! Fits the pooled cubic to reference decays.

use super::model::impossible_multiplier;
use super::{Cubic, CubicError, Decay, DecayUse, Scaling};
use crate::terms::polynomial::{distinct, evaluate, fit_relative};
use crate::terms::{FitQuality, root_mean_square};

/// An inverted decay: (distance, 1 / amplitude), on the scale of the others once `scaled`.
struct Inverse<'a> {
    decay: &'a Decay,
    points: Vec<(f64, f64)>,
    scaling: Scaling,
}

impl Cubic {
    /// Fits the pooled cubic of several reference decays; says for each decay how it was used.
    ///
    /// Every decay that covers the reference distance with at least four positions is normalized there by its own
    /// cubic. The others are scaled onto the pool where they overlap it, because extrapolating them to the
    /// reference would distort the pool. Held-out residual: each normalized decay predicted from the others or,
    /// with one decay, each inner position from the rest.
    ///
    /// # Errors
    /// [`CubicError`] when the distances are too few, none covers the reference, or the fit is not positive.
    pub fn fit(decays: &[Decay], reference_m: f64) -> Result<(Self, Vec<DecayUse>), CubicError> {
        let mut inverses: Vec<Inverse> = decays.iter().map(|decay| invert(decay, reference_m)).collect();
        let pool = pooled(&inverses);
        if pool.is_empty() {
            return Err(no_anchor(&inverses, reference_m));
        }
        scale_onto_pool(&mut inverses)?;
        let pool = pooled(&inverses);
        let coefficients = fit_pool(&pool)?;
        let at_reference = evaluate(coefficients, reference_m);
        let range = range_of(&pool);
        if let Some((distance_m, multiplier)) = impossible_multiplier(coefficients, range) {
            return Err(CubicError::Impossible { distance_m, multiplier });
        }
        let uses = inverses.iter().map(|inverse| inverse.report(coefficients)).collect();
        let cubic = Self {
            version: Self::VERSION,
            coefficients: coefficients.map(|c| c / at_reference),
            valid_distance_m: range,
            fitted_on: Vec::new(),
            fit: FitQuality {
                points: pool.len(),
                residual: relative_residual(coefficients, &pool).unwrap_or(0.0),
                held_out_residual: held_out(&inverses, &pool),
            },
            warnings: Vec::new(),
        };
        Ok((cubic, uses))
    }
}

impl Inverse<'_> {
    fn is_on_scale(&self) -> bool {
        matches!(self.scaling, Scaling::AtReference | Scaling::OntoOthers)
    }

    fn scale(&mut self, factor: f64, scaling: Scaling) {
        self.points.iter_mut().for_each(|point| point.1 *= factor);
        self.scaling = scaling;
    }

    fn report(&self, coefficients: [f64; 4]) -> DecayUse {
        let residual = self.is_on_scale().then(|| relative_residual(coefficients, &self.points)).flatten();
        DecayUse { integration_time_us: self.decay.integration_time_us, scaling: self.scaling, residual }
    }
}

/// Inverts a decay and normalizes it at the reference distance if it covers that.
fn invert(decay: &Decay, reference_m: f64) -> Inverse<'_> {
    let mut points: Vec<_> = decay.points.iter().map(|p| (p.distance_m, 1.0 / p.amplitude_dn)).collect();
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut inverse = Inverse { decay, points, scaling: Scaling::LeftOut };
    let [min_m, max_m] = range_of(&inverse.points);
    if let (true, Some(own)) = ((min_m..=max_m).contains(&reference_m), fit_relative(&inverse.points)) {
        let at_reference = evaluate(own, reference_m);
        if at_reference > 0.0 {
            inverse.scale(1.0 / at_reference, Scaling::AtReference);
        }
    }
    inverse
}

/// Scales the decays that do not reach the reference onto the pool, the one with the largest overlap first.
fn scale_onto_pool(inverses: &mut [Inverse]) -> Result<(), CubicError> {
    loop {
        let pool = pooled(inverses);
        let coefficients = fit_pool(&pool)?;
        let [min_m, max_m] = range_of(&pool);
        let overlap = |inverse: &Inverse| -> Vec<f64> {
            let inside = inverse.points.iter().filter(|(d, _)| (min_m..=max_m).contains(d));
            inside.map(|&(d, y)| (evaluate(coefficients, d) / y).ln()).filter(|log| log.is_finite()).collect()
        };
        let next = inverses
            .iter_mut()
            .filter(|inverse| !inverse.is_on_scale())
            .map(|inverse| (overlap(inverse), inverse))
            .max_by_key(|(logs, _)| logs.len());
        match next {
            Some((logs, inverse)) if !logs.is_empty() => {
                let mean = logs.iter().sum::<f64>() / logs.len() as f64;
                inverse.scale(mean.exp(), Scaling::OntoOthers);
            }
            _ => return Ok(()),
        }
    }
}

fn pooled(inverses: &[Inverse]) -> Vec<(f64, f64)> {
    inverses
        .iter()
        .filter(|inverse| inverse.is_on_scale())
        .flat_map(|inverse| inverse.points.clone())
        .collect()
}

fn fit_pool(pool: &[(f64, f64)]) -> Result<[f64; 4], CubicError> {
    fit_relative(pool).ok_or_else(|| CubicError::TooFewDistances { found: distinct(pool) })
}

fn range_of(points: &[(f64, f64)]) -> [f64; 2] {
    points.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[min, max], &(d, _)| [min.min(d), max.max(d)])
}

fn no_anchor(inverses: &[Inverse], reference_m: f64) -> CubicError {
    let all: Vec<_> = inverses.iter().flat_map(|inverse| inverse.points.clone()).collect();
    let [min_m, max_m] = range_of(&all);
    if (min_m..=max_m).contains(&reference_m) || all.is_empty() {
        CubicError::TooFewDistances { found: inverses.iter().map(|i| i.points.len()).max().unwrap_or(0) }
    } else {
        CubicError::ReferenceOutside { reference_m, min_m, max_m }
    }
}

fn relative_residual(coefficients: [f64; 4], points: &[(f64, f64)]) -> Option<f64> {
    root_mean_square(points.iter().map(|&(d, y)| evaluate(coefficients, d) / y - 1.0))
}

/// Relative error (root mean square) on points that the fit has not seen.
fn held_out(inverses: &[Inverse], pool: &[(f64, f64)]) -> Option<f64> {
    let on_scale: Vec<&Inverse> = inverses.iter().filter(|inverse| inverse.is_on_scale()).collect();
    let mut errors = Vec::new();
    if on_scale.len() >= 2 {
        for left_out in &on_scale {
            let others: Vec<_> = on_scale
                .iter()
                .filter(|i| !std::ptr::eq(**i, *left_out))
                .flat_map(|i| i.points.clone())
                .collect();
            let [min_m, max_m] = range_of(&others);
            let Some(fit) = fit_relative(&others) else { continue };
            let inside = left_out.points.iter().filter(|(d, _)| (min_m..=max_m).contains(d));
            errors.extend(inside.map(|&(d, y)| evaluate(fit, d) / y - 1.0));
        }
    } else {
        for index in 1..pool.len().saturating_sub(1) {
            let mut others = pool.to_vec();
            let (d, y) = others.remove(index);
            errors.extend(fit_relative(&others).map(|fit| evaluate(fit, d) / y - 1.0));
        }
    }
    root_mean_square(errors)
}
