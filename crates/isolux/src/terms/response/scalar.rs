//! Tier T0, `scalar`: one fill time for the whole image, which corrects like a lookup table with two parameters.

use serde::{Deserialize, Serialize};

use super::ResponseError;
use super::well::SoftWell;
use crate::numerics::minimum::minimum;
use crate::terms::check::{Check, ParameterError, Parameters};
use crate::terms::lut::{LutAnswer, RelativeSample};
use crate::terms::{FitQuality, Source, root_mean_square};

/// One well for the image: its mean amplitude follows `t f′(t/τ)`, so that the multiplier is
/// `S(t) = t_ref f′(t_ref/τ) / (t f′(t/τ))` (methods, section 2), 1 at the reference time.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ScalarResponse {
    /// τ: integration time at which the mean charge would fill the well, µs.
    pub full_well_time_us: f64,
    /// Softness p of the well.
    pub softness: f64,
    /// Range in which it holds, µs. It ends at the peak of the mean amplitude.
    pub valid_integration_time_us: [f64; 2],
    /// The recordings that it was fitted to.
    pub fitted_on: Vec<Source>,
    /// How well it fits.
    pub fit: FitQuality,
}

impl ScalarResponse {
    /// Fits τ and p to the mean curve of an exposure sweep, up to its peak. `samples` in any order. Held-out
    /// residual: every fifth inner sample in turn, from a fit to the others.
    ///
    /// # Errors
    /// [`ResponseError`] when fewer than four times are usable.
    pub fn fit(samples: &[RelativeSample], fitted_on: Vec<Source>) -> Result<Self, ResponseError> {
        let fine = |s: &&RelativeSample| s.relative_amplitude > 0.0 && s.relative_amplitude.is_finite();
        let mut points: Vec<[f64; 2]> =
            samples.iter().filter(fine).map(|s| [s.integration_time_us, s.relative_amplitude.ln()]).collect();
        points.sort_by(|a, b| a[0].total_cmp(&b[0]));
        let peak = (0..points.len()).rev().max_by(|&a, &b| points[a][1].total_cmp(&points[b][1]));
        points.truncate(peak.map_or(0, |peak| peak + 1));
        let found = points.len();
        if found < 4 {
            return Err(ResponseError::TooFewTimes { found, expected: 4 });
        }
        let (full_well_time_us, softness, residuals) = search(&points);
        let fit = FitQuality {
            points: found,
            residual: root_mean_square(residuals.into_iter().map(f64::exp_m1)).unwrap_or(0.0),
            held_out_residual: held_out(&points),
        };
        let valid_integration_time_us = [points[0][0], points[found - 1][0]];
        Ok(Self { full_well_time_us, softness, valid_integration_time_us, fitted_on, fit })
    }

    /// The multiplier for one integration time (µs, positive), 1 at `reference_us`.
    #[must_use]
    pub fn at(&self, integration_time_us: f64, reference_us: f64) -> LutAnswer {
        let [min_us, max_us] = self.valid_integration_time_us;
        if integration_time_us > max_us {
            return LutAnswer::Refused;
        }
        let well = SoftWell { softness: self.softness };
        let response = |time_us: f64| time_us * well.slope(time_us / self.full_well_time_us);
        let multiplier = response(reference_us) / response(integration_time_us);
        if integration_time_us < min_us {
            LutAnswer::Below(multiplier)
        } else {
            LutAnswer::Inside(multiplier)
        }
    }
}

impl Parameters for ScalarResponse {
    const NAME: &'static str = "scalar";

    fn check_at(&self, here: &Check<'_>) -> Result<(), ParameterError> {
        let [min_us, max_us] = self.valid_integration_time_us;
        let tau_us = self.full_well_time_us;
        let fine = (1e-3..=1e12).contains(&tau_us);
        here.at("full_well_time_us").require(fine, tau_us, "a time in µs, 1e-3 to 1e12")?;
        SoftWell { softness: self.softness }.check_at(here)?;
        // Beyond ten wells, what is left of the modulation is not usable.
        let inside = 0.0 < min_us && min_us < max_us && max_us <= 10.0 * tau_us;
        let range = format!("{min_us}..{max_us}");
        here.at("valid_integration_time_us").require(inside, range, "a range of µs up to 10 τ")
    }
}

/// τ, p and residuals of the least squares in ln: for every p the best τ. The level is the mean.
fn search(points: &[[f64; 2]]) -> (f64, f64, Vec<f64>) {
    let longest = points.iter().map(|p| p[0]).fold(0.0, f64::max);
    let residuals = |ln_tau: f64, ln_softness: f64| {
        let (well, tau_us) = (SoftWell { softness: ln_softness.exp() }, ln_tau.exp());
        let misfit = |p: &[f64; 2]| p[1] - p[0].ln() - well.slope(p[0] / tau_us).ln();
        let misfits: Vec<f64> = points.iter().map(misfit).collect();
        let level = misfits.iter().sum::<f64>() / misfits.len() as f64;
        misfits.into_iter().map(|m| m - level).collect::<Vec<_>>()
    };
    let cost = |ln_tau, ln_softness| residuals(ln_tau, ln_softness).iter().map(|r| r * r).sum::<f64>();
    // From a well that is full before the sweep's end to one that the sweep fills by a hundredth.
    let taus = [(0.5 * longest).ln(), (100.0 * longest).ln()];
    let best_tau = |ln_softness: f64| minimum(taus, |ln_tau| cost(ln_tau, ln_softness));
    let limits = [SoftWell::SOFTNESS_LIMITS.start().ln(), SoftWell::SOFTNESS_LIMITS.end().ln()];
    let ln_softness = minimum(limits, |ln_softness| cost(best_tau(ln_softness), ln_softness));
    let ln_tau = best_tau(ln_softness);
    (ln_tau.exp(), ln_softness.exp(), residuals(ln_tau, ln_softness))
}

/// Relative error (root mean square) on inner samples, every fifth left out in turn.
fn held_out(points: &[[f64; 2]]) -> Option<f64> {
    const FOLDS: usize = 5;
    if points.len() < 6 {
        return None;
    }
    let is_inner = |i: usize| 0 < i && i + 1 < points.len();
    let mut errors = Vec::new();
    for fold in 0..FOLDS {
        let left_out = |i: usize| is_inner(i) && i % FOLDS == fold;
        let rest: Vec<[f64; 2]> = (0..points.len()).filter(|&i| !left_out(i)).map(|i| points[i]).collect();
        let (tau_us, softness, residuals) = search(&rest);
        let well = SoftWell { softness };
        let shape = |p: &[f64; 2]| p[1] - p[0].ln() - well.slope(p[0] / tau_us).ln();
        let level = shape(&rest[0]) - residuals[0];
        let tested = (0..points.len()).filter(|&i| left_out(i));
        errors.extend(tested.map(|i| (shape(&points[i]) - level).exp_m1()));
    }
    root_mean_square(errors)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::terms::{Lut, linear};

    fn samples(times: &[f64], curve: impl Fn(f64) -> f64) -> Vec<RelativeSample> {
        let sample =
            |&t: &f64| RelativeSample { integration_time_us: t, relative_amplitude: curve(t), spread: 0.0 };
        times.iter().map(sample).collect()
    }

    fn inside(answer: LutAnswer) -> f64 {
        let LutAnswer::Inside(multiplier) = answer else { panic!("{answer:?}") };
        multiplier
    }

    const TIMES_US: [f64; 9] = [200.0, 600.0, 1400.0, 3000.0, 6000.0, 8200.0, 12000.0, 16000.0, 20000.0];

    fn response(full_well_time_us: f64, softness: f64) -> ScalarResponse {
        let fit = FitQuality { points: 9, residual: 0.0, held_out_residual: None };
        let valid_integration_time_us = [200.0, 20000.0];
        let fitted_on = Vec::new();
        ScalarResponse { full_well_time_us, softness, valid_integration_time_us, fitted_on, fit }
    }

    #[test]
    fn one_tau_equals_the_table_of_its_own_curve() {
        let scalar = response(30_000.0, 5.0);
        let well = SoftWell { softness: 5.0 };
        let lut = Lut::of_curve(&samples(&TIMES_US, |t| 0.3 * t * well.slope(t / 30_000.0)), 8200.0).unwrap();
        for time_us in TIMES_US {
            let ratio = inside(scalar.at(time_us, 8200.0)) / inside(lut.at(time_us));
            assert!((ratio - 1.0).abs() < 1e-12, "{time_us}: {ratio}");
        }
        assert_eq!(scalar.at(20000.1, 8200.0), LutAnswer::Refused);
        assert!(matches!(scalar.at(100.0, 8200.0), LutAnswer::Below(m) if (m / 82.0 - 1.0).abs() < 0.01));
    }

    #[test]
    fn a_well_that_never_fills_is_the_linear_law() {
        let scalar = response(1e12, 8.0);
        for time_us in TIMES_US {
            let ratio = inside(scalar.at(time_us, 8200.0)) / linear::multiplier(time_us, 8200.0);
            assert!((ratio - 1.0).abs() < 1e-12, "{time_us}: {ratio}");
        }
    }

    #[test]
    fn the_fit_recovers_the_well_of_its_own_model() {
        for (tau_us, softness) in [(25_000.0, 4.0), (30_000.0, 8.0), (40_000.0, 5.5)] {
            let well = SoftWell { softness };
            let found =
                ScalarResponse::fit(&samples(&TIMES_US, |t| 0.3 * t * well.slope(t / tau_us)), Vec::new())
                    .unwrap();
            // Without noise only the last grid's step is left, and the softness where hardly anything is compressed.
            assert!((found.full_well_time_us / tau_us - 1.0).abs() < 1e-3, "{found:?}");
            assert!((found.softness / softness - 1.0).abs() < 1e-2, "{found:?}");
            assert!(found.fit.residual < 1e-5 && found.fit.held_out_residual.unwrap() < 1e-4, "{found:?}");
        }
    }

    #[test]
    fn too_few_times_are_refused() {
        let error = ScalarResponse::fit(&samples(&TIMES_US[..3], |t| t), Vec::new()).unwrap_err();
        assert_eq!(error, ResponseError::TooFewTimes { found: 3, expected: 4 });
    }
}
