//! `lut`: the paper's lookup table over integration time (section 2.1, eq. 4): one scalar per time, the inverse
//! of the mean amplitude of the whole image, 1 at the reference time.

use serde::{Deserialize, Serialize};

use super::{FitQuality, MULTIPLIER_LIMITS, ParameterError, Source, require, root_mean_square};

/// The mean image amplitude at one integration time of an exposure sweep.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ExposureSample {
    /// Integration time, µs.
    pub integration_time_us: f64,
    /// Mean amplitude of the valid pixels over all frames of this time, DN.
    pub mean_amplitude_dn: f64,
    /// Root mean square of the relative deviation of single frames from that mean.
    pub frame_spread: f64,
}

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
    /// Range in which the table holds, µs. It ends at the peak of the mean amplitude: beyond, over-saturation
    /// makes the curve fall again.
    pub valid_integration_time_us: [f64; 2],
    /// What it was fitted on.
    pub fitted_on: Vec<Source>,
    /// How well it fits.
    pub fit: FitQuality,
    /// What the user should know or record better.
    pub warnings: Vec<String>,
}

/// What the table says of one integration time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LutAnswer {
    /// Multiplier inside the valid range.
    Inside(f64),
    /// Below the lowest sample: multiplier continued in proportion to 1/t.
    Below(f64),
    /// Above the valid range: over-saturated, no multiplier.
    Refused,
}

/// Why no table could be made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LutError {
    /// Fewer than two usable integration times.
    #[error(
        "{found} usable integration times found, at least 2 expected: vary the integration time in the sweep"
    )]
    TooFewTimes {
        /// Number found.
        found: usize,
    },
    /// The reference time is not inside the usable range.
    #[error(
        "the reference time of {reference_us} µs is outside the usable sweep of {min_us} to {max_us} µs: \
         record further, or choose another with --reference-time-us"
    )]
    ReferenceOutside {
        /// Reference asked for, µs.
        reference_us: f64,
        /// Lowest usable time, µs.
        min_us: f64,
        /// Time of the peak, µs.
        max_us: f64,
    },
    /// A mean amplitude is zero or not finite.
    #[error(
        "the mean amplitude at {integration_time_us} µs is {mean_amplitude_dn}: no valid pixel there; \
             leave this time out with --exclude-time-us"
    )]
    NoSignal {
        /// Time, µs.
        integration_time_us: f64,
        /// Mean found.
        mean_amplitude_dn: f64,
    },
}

impl Lut {
    /// Parameter version that this library writes.
    pub const VERSION: u32 = 1;

    /// Fits the table of one sweep: multiplier(t) = mean(t_ref) / mean(t), up to the peak of the mean curve.
    /// `samples` in any order, one per time.
    ///
    /// The held-out residual predicts each inner sample from its two neighbours.
    ///
    /// # Errors
    /// [`LutError`] when a mean is no number, the times are too few or the reference lies outside them.
    pub fn fit(samples: &[ExposureSample], reference_time_us: f64) -> Result<Self, LutError> {
        let mut samples = samples.to_vec();
        samples.sort_by(|a, b| a.integration_time_us.total_cmp(&b.integration_time_us));
        for sample in &samples {
            if !(sample.mean_amplitude_dn > 0.0 && sample.mean_amplitude_dn.is_finite()) {
                let ExposureSample { integration_time_us, mean_amplitude_dn, .. } = *sample;
                return Err(LutError::NoSignal { integration_time_us, mean_amplitude_dn });
            }
        }
        let mut peak = 0;
        for (index, sample) in samples.iter().enumerate() {
            if sample.mean_amplitude_dn > samples[peak].mean_amplitude_dn {
                peak = index;
            }
        }
        samples.truncate(peak + 1);
        let (Some(first), Some(last), 2..) = (samples.first(), samples.last(), samples.len()) else {
            return Err(LutError::TooFewTimes { found: samples.len() });
        };
        let (min_us, max_us) = (first.integration_time_us, last.integration_time_us);
        if !(min_us..=max_us).contains(&reference_time_us) {
            return Err(LutError::ReferenceOutside { reference_us: reference_time_us, min_us, max_us });
        }
        let times: Vec<f64> = samples.iter().map(|s| s.integration_time_us).collect();
        let means: Vec<f64> = samples.iter().map(|s| s.mean_amplitude_dn).collect();
        let at_reference = interpolate_log_log(&times, &means, reference_time_us);
        let fit = FitQuality {
            points: times.len(),
            residual: root_mean_square(samples.iter().map(|s| s.frame_spread)).unwrap_or(0.0),
            held_out_residual: held_out(&times, &means),
        };
        Ok(Self {
            version: Self::VERSION,
            multiplier: means.iter().map(|mean| at_reference / mean).collect(),
            integration_time_us: times,
            valid_integration_time_us: [min_us, max_us],
            fitted_on: Vec::new(),
            fit,
            warnings: Vec::new(),
        })
    }

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

    /// The mean curve behind the table, 1 at the reference time.
    #[must_use]
    pub fn samples(&self) -> Vec<ExposureSample> {
        let sample = |(&integration_time_us, multiplier): (&f64, &f64)| ExposureSample {
            integration_time_us,
            mean_amplitude_dn: 1.0 / multiplier,
            frame_spread: 0.0,
        };
        self.integration_time_us.iter().zip(&self.multiplier).map(sample).collect()
    }

    /// Refuses parameters that no fit can have written.
    ///
    /// # Errors
    /// [`ParameterError`] names the field.
    pub fn check(&self) -> Result<(), ParameterError> {
        let (times, multipliers) = (&self.integration_time_us, &self.multiplier);
        let [min_us, max_us] = self.valid_integration_time_us;
        require(self.version == Self::VERSION, "lut.version", self.version, "1")?;
        require(
            times.len() >= 2,
            "lut.integration_time_us",
            format!("{} times", times.len()),
            "at least 2 times",
        )?;
        let counts = format!("{} for {} integration times", multipliers.len(), times.len());
        require(times.len() == multipliers.len(), "lut.multiplier", counts, "one for each integration time")?;
        let increasing =
            times[0] > 0.0 && times.windows(2).all(|w| w[0] < w[1]) && times[times.len() - 1].is_finite();
        require(
            increasing,
            "lut.integration_time_us",
            "not increasing from above 0",
            "increasing positive times in µs",
        )?;
        let impossible = multipliers.iter().find(|multiplier| !MULTIPLIER_LIMITS.contains(*multiplier));
        let found = impossible.map_or_else(String::new, f64::to_string);
        require(found.is_empty(), "lut.multiplier", found, "numbers from 1e-12 to 1e12")?;
        let inside = times[0] <= min_us && min_us < max_us && max_us <= times[times.len() - 1];
        let range = format!("{min_us}..{max_us}");
        require(inside, "lut.valid_integration_time_us", range, "a range inside the sampled times")
    }
}

/// Straight line in (ln x, ln y) between the neighbours of `x`, which must lie inside `xs` (increasing, ≥ 1 value).
/// Linear interpolation would be 29 % off at 1 ms on a 1.2 ms grid, because the curve is close to 1/t.
fn interpolate_log_log(xs: &[f64], ys: &[f64], x: f64) -> f64 {
    let above = xs.partition_point(|&sample| sample < x).min(xs.len() - 1);
    if above == 0 || xs[above] == x {
        return ys[above];
    }
    let below = above - 1;
    let fraction = (x / xs[below]).ln() / (xs[above] / xs[below]).ln();
    (ys[below].ln() + fraction * (ys[above] / ys[below]).ln()).exp()
}

/// Relative error (root mean square) of predicting each inner sample from its neighbours.
fn held_out(times: &[f64], means: &[f64]) -> Option<f64> {
    root_mean_square((1..times.len().saturating_sub(1)).map(|i| {
        let neighbours = |values: &[f64]| [values[i - 1], values[i + 1]];
        interpolate_log_log(&neighbours(times), &neighbours(means), times[i]) / means[i] - 1.0
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn samples(curve: impl Fn(f64) -> f64, times: &[f64]) -> Vec<ExposureSample> {
        let sample = |&t: &f64| ExposureSample {
            integration_time_us: t,
            mean_amplitude_dn: curve(t),
            frame_spread: 0.0,
        };
        times.iter().map(sample).collect()
    }

    #[test]
    fn a_linear_camera_gives_the_linear_law_between_samples_too() {
        let lut = Lut::fit(&samples(|t| 0.3 * t, &[200.0, 1400.0, 8200.0, 20000.0]), 8200.0).unwrap();
        for time in [200.0, 1000.0, 8200.0, 15000.0] {
            let LutAnswer::Inside(multiplier) = lut.at(time) else { panic!("{time}") };
            assert!((multiplier / super::super::linear::multiplier(time, 8200.0) - 1.0).abs() < 1e-12);
        }
        assert_eq!(lut.fit.held_out_residual.map(|r| r < 1e-12), Some(true));
    }

    #[test]
    fn the_table_ends_at_the_peak_and_continues_as_one_over_t_below() {
        let curve = |t: f64| t * (-t / 20000.0).exp();
        let times: Vec<f64> = (1..=50).map(|i| f64::from(i) * 1000.0).collect();
        let lut = Lut::fit(&samples(curve, &times), 8200.0).unwrap();
        assert_eq!(lut.valid_integration_time_us, [1000.0, 20000.0]);
        assert_eq!(lut.at(20000.1), LutAnswer::Refused);
        let (LutAnswer::Inside(edge), LutAnswer::Below(half)) = (lut.at(1000.0), lut.at(500.0)) else {
            panic!()
        };
        assert!((half / edge - 2.0).abs() < 1e-12);
        assert!(lut.check().is_ok());
    }

    #[test]
    fn the_reference_must_lie_in_the_sweep() {
        let error = Lut::fit(&samples(|t| t, &[200.0, 400.0]), 8200.0).unwrap_err();
        assert_eq!(error, LutError::ReferenceOutside { reference_us: 8200.0, min_us: 200.0, max_us: 400.0 });
        assert_eq!(Lut::fit(&[], 8200.0).unwrap_err(), LutError::TooFewTimes { found: 0 });
        let dark = Lut::fit(&samples(|_| 0.0, &[200.0, 400.0]), 300.0).unwrap_err();
        assert!(matches!(dark, LutError::NoSignal { .. }));
    }

    #[test]
    fn edited_tables_are_checked() {
        let good = Lut::fit(&samples(|t| t, &[200.0, 400.0, 800.0]), 400.0).unwrap();
        let spoil = |change: fn(&mut Lut)| {
            let mut lut = good.clone();
            change(&mut lut);
            lut.check().unwrap_err().field
        };
        assert_eq!(spoil(|l| l.version = 2), "lut.version");
        assert_eq!(spoil(|l| l.multiplier.truncate(1)), "lut.multiplier");
        assert_eq!(spoil(|l| l.multiplier[1] = -1.0), "lut.multiplier");
        assert_eq!(spoil(|l| l.integration_time_us[1] = f64::NAN), "lut.integration_time_us");
        assert_eq!(spoil(|l| l.integration_time_us.clear()), "lut.integration_time_us");
        assert_eq!(spoil(|l| l.valid_integration_time_us = [200.0, 900.0]), "lut.valid_integration_time_us");
    }
}
