//! Fits the table to the mean curve of an exposure sweep.

use super::model::interpolate_log_log;
use super::{ExposureSample, Lut, LutError, RelativeSample};
use crate::terms::{FitQuality, root_mean_square};

impl Lut {
    /// Fits the table of one sweep: multiplier(t) = mean(t_ref) / mean(t), up to the peak of the mean curve.
    /// `samples` in any order, one per time.
    ///
    /// The held-out residual predicts each inner sample from its two neighbours.
    ///
    /// # Errors
    /// [`LutError`] when a mean is no number, the times are too few or the reference lies outside them.
    pub fn fit(samples: &[ExposureSample], reference_time_us: f64) -> Result<Self, LutError> {
        let curve: Vec<RelativeSample> = samples.iter().map(|&sample| sample.into()).collect();
        Self::of_curve(&curve, reference_time_us)
    }

    /// The integration times, µs, that a table of these samples would cover; `None` without samples.
    #[must_use]
    pub fn covered_us(samples: &[ExposureSample]) -> Option<[f64; 2]> {
        let curve: Vec<RelativeSample> = samples.iter().map(|&sample| sample.into()).collect();
        let rising = up_to_peak(&curve);
        Some([rising.first()?.integration_time_us, rising.last()?.integration_time_us])
    }

    /// The same as [`Lut::fit`] for a curve of unknown scale.
    ///
    /// # Errors
    /// As [`Lut::fit`].
    pub fn of_curve(samples: &[RelativeSample], reference_time_us: f64) -> Result<Self, LutError> {
        for sample in samples {
            let RelativeSample { integration_time_us, relative_amplitude: mean_amplitude, .. } = *sample;
            if !(mean_amplitude > 0.0 && mean_amplitude.is_finite()) {
                return Err(LutError::NoSignal { integration_time_us, mean_amplitude });
            }
        }
        let samples = up_to_peak(samples);
        let (Some(first), Some(last), 2..) = (samples.first(), samples.last(), samples.len()) else {
            return Err(LutError::TooFewTimes { found: samples.len() });
        };
        let (min_us, max_us) = (first.integration_time_us, last.integration_time_us);
        if !(min_us..=max_us).contains(&reference_time_us) {
            return Err(LutError::ReferenceOutside { reference_us: reference_time_us, min_us, max_us });
        }
        let times: Vec<f64> = samples.iter().map(|s| s.integration_time_us).collect();
        let means: Vec<f64> = samples.iter().map(|s| s.relative_amplitude).collect();
        let at_reference = interpolate_log_log(&times, &means, reference_time_us);
        let fit = FitQuality {
            points: times.len(),
            residual: root_mean_square(samples.iter().map(|s| s.spread)).unwrap_or(0.0),
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
}

/// The samples in the order of their times, up to the peak of the curve: beyond, pixels are over-saturated.
fn up_to_peak(samples: &[RelativeSample]) -> Vec<RelativeSample> {
    let mut samples = samples.to_vec();
    samples.sort_by(|a, b| a.integration_time_us.total_cmp(&b.integration_time_us));
    let mut peak = 0;
    for (index, sample) in samples.iter().enumerate() {
        if sample.relative_amplitude > samples[peak].relative_amplitude {
            peak = index;
        }
    }
    samples.truncate(peak + 1);
    samples
}

/// Relative error (root mean square) of predicting each inner sample from its neighbours.
fn held_out(times: &[f64], means: &[f64]) -> Option<f64> {
    root_mean_square((1..times.len().saturating_sub(1)).map(|i| {
        let neighbours = |values: &[f64]| [values[i - 1], values[i + 1]];
        interpolate_log_log(&neighbours(times), &neighbours(means), times[i]) / means[i] - 1.0
    }))
}
