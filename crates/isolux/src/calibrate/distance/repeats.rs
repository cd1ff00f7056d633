//! The noise of the amplitude from repeated frames of one position of the target.

use super::centre::Measurement;
use crate::frame::Frame;
use crate::numerics::differences::trimmed_deviation;
use crate::numerics::statistics::median;
use crate::terms::response::NoiseOfSample;

/// Pixels that look like those of the window share its fill: amplitudes and distances within these shares, or within
/// this many standard deviations where noise is larger.
const AMPLITUDE_SHARE: f64 = 0.15;
const DISTANCE_SHARE: f64 = 0.03;
const STANDARD_DEVIATIONS: f64 = 5.0;
/// Fewer differences tell no variance: their relative error would be 10 % or more.
const LEAST_DIFFERENCES: usize = 200;

/// Remembers the last frame.
#[derive(Clone, Debug, Default)]
pub(super) struct Repeats {
    /// Amplitudes, DN; NaN where a pixel takes no part.
    previous: Vec<f32>,
}

impl Repeats {
    /// Takes the next frame. The noise of its amplitude where it `repeats` the last one.
    pub(super) fn push(
        &mut self,
        frame: &Frame,
        distances_m: &[f32],
        window: &Measurement,
        repeats: bool,
    ) -> Option<NoiseOfSample> {
        let near = |value: f32, mean: f64, deviation: f64, share: f64| {
            let most = (STANDARD_DEVIATIONS * deviation).max(share * mean);
            (f64::from(value) - mean).abs() <= most
        };
        let amplitude_sd = window.amplitude_dn / window.signal_to_noise;
        let amplitudes = frame.amplitude.values();
        let taken = |index: usize| {
            frame.is_valid(index)
                && near(amplitudes[index], window.amplitude_dn, amplitude_sd, AMPLITUDE_SHARE)
                && near(distances_m[index], window.distance_m, window.distance_sd_m, DISTANCE_SHARE)
        };
        let now: Vec<f32> =
            (0..amplitudes.len()).map(|i| if taken(i) { amplitudes[i] } else { f32::NAN }).collect();
        let before = std::mem::replace(&mut self.previous, now);
        if !repeats {
            return None;
        }
        let pairs = before.iter().zip(&self.previous);
        let differences = pairs.map(|(before, now)| f64::from(*now) - f64::from(*before));
        let mut differences: Vec<f64> = differences.filter(|difference| difference.is_finite()).collect();
        if differences.len() < LEAST_DIFFERENCES {
            return None;
        }
        // Warm-up changes all of them alike.
        let common = median(&mut differences)?;
        differences.iter_mut().for_each(|difference| *difference -= common);
        let deviation = trimmed_deviation(&mut differences)?;
        let variance_dn2 = 0.5 * deviation * deviation;
        (variance_dn2 > 0.0).then_some(NoiseOfSample { variance_dn2, differences: differences.len() as f64 })
    }
}
