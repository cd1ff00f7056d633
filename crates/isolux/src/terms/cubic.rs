//! `cubic`: the paper's polynomial over distance (section 2.2): reference decays are inverted, normalized at the
//! reference distance, and pooled under one cubic.

use serde::{Deserialize, Serialize};

use super::polynomial::{distinct, evaluate, fit_relative};
use super::{
    DistanceGain, DistanceLaw, FitQuality, MULTIPLIER_LIMITS, ParameterError, Source, require,
    root_mean_square,
};

/// Amplitude and distance of the flat target at one position.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DecayPoint {
    /// Mean distance in the window, m.
    pub distance_m: f64,
    /// Mean amplitude in the window, DN.
    pub amplitude_dn: f64,
}

/// The reference decay of one integration time.
#[derive(Clone, Debug, PartialEq)]
pub struct Decay {
    /// Integration time, µs; `None` where the recording does not know it.
    pub integration_time_us: Option<f64>,
    /// Positions, in any order.
    pub points: Vec<DecayPoint>,
}

/// What became of one reference decay in the fit.
#[derive(Clone, Debug, PartialEq)]
pub struct DecayUse {
    /// Integration time of the decay, µs.
    pub integration_time_us: Option<f64>,
    /// How it was brought to the common scale.
    pub scaling: Scaling,
    /// Root mean square of the relative error that the pooled cubic leaves on it.
    pub residual: Option<f64>,
}

/// How a decay was brought to the common scale.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scaling {
    /// Normalized by its own cubic at the reference distance.
    AtReference,
    /// It does not reach the reference distance: scaled onto the others where they overlap.
    OntoOthers,
    /// Neither reaches the reference nor overlaps the others: not used.
    LeftOut,
}

/// Cubic multiplier over distance.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Cubic {
    /// Version of this term's parameters.
    pub version: u32,
    /// Coefficients of 1, d, d², d³ with d in metres; P(reference distance) = 1.
    pub coefficients: [f64; 4],
    /// Distances that the reference decays covered, m. Outside, the multiplier goes on with the slope of d².
    pub valid_distance_m: [f64; 2],
    /// What it was fitted on.
    pub fitted_on: Vec<Source>,
    /// How well it fits.
    pub fit: FitQuality,
    /// What the user should know or record better.
    pub warnings: Vec<String>,
}

/// Why no cubic could be fitted.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CubicError {
    /// Fewer than four distances.
    #[error(
        "{found} different distances found in the usable part of the sweep, at least 4 expected: \
         record the target at more distances"
    )]
    TooFewDistances {
        /// Number found.
        found: usize,
    },
    /// No decay covers the reference distance.
    #[error(
        "no reference decay covers the reference distance of {reference_m} m (the sweep has {min_m:.3} to \
         {max_m:.3} m): record there, or choose another with --reference-distance-m"
    )]
    ReferenceOutside {
        /// Reference asked for, m.
        reference_m: f64,
        /// Nearest usable distance, m.
        min_m: f64,
        /// Farthest usable distance, m.
        max_m: f64,
    },
    /// The multiplier is not positive, or beyond all reason, somewhere in its range.
    #[error(
        "the cubic is {multiplier:.3e} at {distance_m:.3} m, a multiplier from 1e-12 to 1e12 expected: record more \
         distances, evenly spread"
    )]
    Impossible {
        /// Where, m.
        distance_m: f64,
        /// Value there.
        multiplier: f64,
    },
}

/// A decay turned over: (distance, 1 / amplitude), on the scale of the others once `scaled`.
struct Inverse<'a> {
    decay: &'a Decay,
    points: Vec<(f64, f64)>,
    scaling: Scaling,
}

impl Cubic {
    /// Parameter version that this library writes.
    pub const VERSION: u32 = 1;

    /// Fits the pooled cubic of several reference decays; says for each decay how it was used.
    ///
    /// Every decay that covers the reference distance with at least four positions is normalized there by its
    /// own cubic. The others are scaled onto the pool where they overlap it: extrapolating them to the reference
    /// would spoil the pool. Held-out residual: each normalized decay predicted from the others or, with one
    /// decay, each inner position from the rest.
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
        check_multiplier(coefficients, range)?;
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

    /// The multiplier in the form that the hot loop evaluates.
    #[must_use]
    pub fn distance_law(&self) -> DistanceLaw {
        DistanceGain::between(self.coefficients, self.valid_distance_m[0], self.valid_distance_m[1]).into()
    }

    /// Refuses parameters that no fit can have written.
    ///
    /// # Errors
    /// [`ParameterError`] names the field.
    pub fn check(&self) -> Result<(), ParameterError> {
        let [min_m, max_m] = self.valid_distance_m;
        require(self.version == Self::VERSION, "cubic.version", self.version, "1")?;
        let finite = self.coefficients.iter().all(|c| c.is_finite());
        require(finite, "cubic.coefficients", "a value that is not finite", "four numbers")?;
        let ordered = 0.0 < min_m && min_m < max_m && max_m.is_finite();
        require(
            ordered,
            "cubic.valid_distance_m",
            format!("{min_m}..{max_m}"),
            "two increasing distances in metres",
        )?;
        let positive = check_multiplier(self.coefficients, self.valid_distance_m);
        let found = positive.map_or_else(|error| error.to_string(), |()| String::new());
        require(
            found.is_empty(),
            "cubic.coefficients",
            found,
            "a multiplier from 1e-12 to 1e12 over its range",
        )
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

/// Turns a decay over and normalizes it at the reference where it reaches there.
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

fn check_multiplier(coefficients: [f64; 4], [min_m, max_m]: [f64; 2]) -> Result<(), CubicError> {
    const STEPS: u32 = 256;
    for step in 0..=STEPS {
        let distance_m = min_m + (max_m - min_m) * f64::from(step) / f64::from(STEPS);
        let multiplier = evaluate(coefficients, distance_m);
        if !MULTIPLIER_LIMITS.contains(&multiplier) {
            return Err(CubicError::Impossible { distance_m, multiplier });
        }
    }
    Ok(())
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Decay of an exact d² camera with an amplitude of `scale` at 1 m.
    fn decay(time: f64, scale: f64, distances: impl IntoIterator<Item = f64>) -> Decay {
        let point = |d: f64| DecayPoint { distance_m: d, amplitude_dn: scale / (d * d) };
        Decay { integration_time_us: Some(time), points: distances.into_iter().map(point).collect() }
    }

    fn steps(from: f64, to: f64, count: u32) -> impl Iterator<Item = f64> {
        (0..count).map(move |i| from + (to - from) * f64::from(i) / f64::from(count - 1))
    }

    #[test]
    fn a_square_law_camera_gives_the_square() {
        let decays = [decay(1000.0, 700.0, steps(0.5, 3.0, 11)), decay(4000.0, 2800.0, steps(0.7, 3.0, 9))];
        let (cubic, uses) = Cubic::fit(&decays, 0.75).unwrap();
        let [c0, c1, c2, c3] = cubic.coefficients;
        assert!(c0.abs() < 1e-9 && c1.abs() < 1e-9 && (c2 - 1.0 / 0.5625).abs() < 1e-9 && c3.abs() < 1e-9);
        assert_eq!(cubic.valid_distance_m, [0.5, 3.0]);
        assert!(cubic.fit.residual < 1e-12);
        assert!(uses.iter().all(|used| used.scaling == Scaling::AtReference));
        assert!(cubic.check().is_ok());
    }

    #[test]
    fn a_decay_that_does_not_reach_the_reference_is_scaled_on_and_not_extrapolated() {
        let decays = [
            decay(1000.0, 700.0, steps(0.5, 2.0, 9)),
            decay(9000.0, 5000.0, steps(1.5, 3.5, 9)),
            decay(9500.0, 5000.0, steps(3.0, 5.0, 9)),
            decay(9900.0, 5000.0, steps(8.0, 9.0, 9)),
        ];
        let (cubic, uses) = Cubic::fit(&decays, 0.75).unwrap();
        let scalings: Vec<_> = uses.iter().map(|used| used.scaling).collect();
        assert_eq!(
            scalings,
            [Scaling::AtReference, Scaling::OntoOthers, Scaling::OntoOthers, Scaling::LeftOut]
        );
        assert_eq!(cubic.valid_distance_m, [0.5, 5.0]);
        assert!((evaluate(cubic.coefficients, 4.0) - 16.0 / 0.5625).abs() < 1e-6);
        assert_eq!(uses[3].residual, None);
    }

    #[test]
    fn what_cannot_be_fitted_is_refused_with_the_reason() {
        let far = Cubic::fit(&[decay(1.0, 1.0, steps(1.0, 3.0, 9))], 0.75).unwrap_err();
        assert!(matches!(far, CubicError::ReferenceOutside { .. }), "{far}");
        let few = Cubic::fit(&[decay(1.0, 1.0, [0.5, 1.0, 2.0])], 0.75).unwrap_err();
        assert_eq!(few, CubicError::TooFewDistances { found: 3 });
        assert_eq!(Cubic::fit(&[], 0.75).unwrap_err(), CubicError::TooFewDistances { found: 0 });
    }

    #[test]
    fn a_cubic_that_dips_below_zero_is_refused_when_read() {
        let (mut cubic, _) = Cubic::fit(&[decay(1.0, 1.0, steps(0.5, 3.0, 9))], 0.75).unwrap();
        cubic.coefficients = [1.0, -1.0, 0.0, 0.0];
        assert_eq!(cubic.check().unwrap_err().field, "cubic.coefficients");
        cubic.valid_distance_m = [3.0, 0.5];
        assert_eq!(cubic.check().unwrap_err().field, "cubic.valid_distance_m");
    }
}
