//! The parameters of the table, their check, and the multiplier of a time.

use serde::{Deserialize, Serialize};

use super::RelativeSample;
use crate::terms::check::{Check, ParameterError, Parameters};
use crate::terms::{FitQuality, MULTIPLIER_LIMITS, Source};

/// Lookup table over integration time.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Lut {
    /// Version of this term's parameters.
    pub version: u32,
    /// Integration times, µs, increasing.
    pub integration_time_us: Vec<f64>,
    /// Multiplier S(t) at each of them, dimensionless.
    pub multiplier: Vec<f64>,
    /// Range in which the table is valid, µs. It ends at the peak of the mean amplitude, beyond which
    /// over-saturation makes the curve fall.
    pub valid_integration_time_us: [f64; 2],
    /// The recordings that it was fitted to.
    pub fitted_on: Vec<Source>,
    /// How well it fits.
    pub fit: FitQuality,
    /// Warnings of the fit: what the user should know or record better.
    pub warnings: Vec<String>,
}

/// The multiplier of one integration time, or none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LutAnswer {
    /// Multiplier inside the valid range.
    Inside(f64),
    /// Below the valid range: the multiplier, extrapolated in proportion to 1/t.
    Below(f64),
    /// Above the valid range: over-saturated, no multiplier.
    Refused,
}

impl Lut {
    /// Parameter version that this library writes.
    pub const VERSION: u32 = 1;

    /// The multiplier for one integration time (µs, positive): interpolated log–log between samples.
    #[must_use]
    pub fn at(&self, integration_time_us: f64) -> LutAnswer {
        let [min_us, max_us] = self.valid_integration_time_us;
        if integration_time_us > max_us {
            LutAnswer::Refused
        } else if integration_time_us < min_us {
            let at_edge = interpolate_log_log(&self.integration_time_us, &self.multiplier, min_us);
            LutAnswer::Below(at_edge * min_us / integration_time_us)
        } else {
            LutAnswer::Inside(interpolate_log_log(
                &self.integration_time_us,
                &self.multiplier,
                integration_time_us,
            ))
        }
    }

    /// The mean curve that the table is the inverse of, 1 at the reference time.
    #[must_use]
    pub fn curve(&self) -> Vec<RelativeSample> {
        let sample = |(&integration_time_us, multiplier): (&f64, &f64)| RelativeSample {
            integration_time_us,
            relative_amplitude: 1.0 / multiplier,
            spread: 0.0,
        };
        self.integration_time_us.iter().zip(&self.multiplier).map(sample).collect()
    }

    /// This table with the recordings that it was fitted on, and what the user should know of them.
    #[must_use]
    pub(crate) fn with_origin(self, fitted_on: Vec<Source>, warnings: Vec<String>) -> Self {
        Self { fitted_on, warnings, ..self }
    }

    /// Refuses parameters that no fit gives.
    ///
    /// # Errors
    /// [`ParameterError`] names the field.
    pub fn check(&self) -> Result<(), ParameterError> {
        self.check_at(&Check::of(Self::NAME))
    }
}

impl Parameters for Lut {
    const NAME: &'static str = "lut";

    fn check_at(&self, here: &Check<'_>) -> Result<(), ParameterError> {
        here.version(self.version, Self::VERSION)?;
        let (times, multipliers) = (&self.integration_time_us, &self.multiplier);
        let at_times = here.at("integration_time_us");
        at_times.require(times.len() >= 2, format!("{} times", times.len()), "at least 2 times")?;
        let counts = format!("{} for {} integration times", multipliers.len(), times.len());
        let at_multipliers = here.at("multiplier");
        at_multipliers.require(times.len() == multipliers.len(), counts, "one for each integration time")?;
        let increasing =
            times[0] > 0.0 && times.windows(2).all(|w| w[0] < w[1]) && times[times.len() - 1].is_finite();
        let expected = "increasing positive times in µs";
        at_times.require(increasing, "not increasing from above 0", expected)?;
        let impossible = multipliers.iter().find(|multiplier| !MULTIPLIER_LIMITS.contains(*multiplier));
        let found = impossible.map_or_else(String::new, f64::to_string);
        at_multipliers.require(impossible.is_none(), found, "numbers from 1e-12 to 1e12")?;
        let [min_us, max_us] = self.valid_integration_time_us;
        let inside = times[0] <= min_us && min_us < max_us && max_us <= times[times.len() - 1];
        let range = format!("{min_us}..{max_us}");
        here.at("valid_integration_time_us").require(inside, range, "a range inside the sampled times")
    }
}

/// Straight line in (ln x, ln y) between the neighbours of `x`, which must lie inside `xs` (increasing, ≥ 1 value).
/// Linear interpolation would be 29 % off at 1 ms on a 1.2 ms grid, because the curve is close to 1/t.
pub(super) fn interpolate_log_log(xs: &[f64], ys: &[f64], x: f64) -> f64 {
    let above = xs.partition_point(|&sample| sample < x).min(xs.len() - 1);
    if above == 0 || xs[above] == x {
        return ys[above];
    }
    let below = above - 1;
    let fraction = (x / xs[below]).ln() / (xs[above] / xs[below]).ln();
    (ys[below].ln() + fraction * (ys[above] / ys[below]).ln()).exp()
}
