//! Measures the central window of one frame of a distance sweep.

use crate::frame::{Frame, Window};
use crate::numerics::differences;

/// Frames with more invalid pixels in the window than this share are left out.
const INVALID_SHARE: f64 = 0.05;
/// A spread of more than this many standard errors is a tilt.
const STANDARD_ERRORS: f64 = 8.0;

/// The measurement of one frame's window.
#[derive(Clone, Copy, Debug)]
pub(super) struct Measurement {
    /// Mean distance.
    pub(super) distance_m: f64,
    /// Noise of one pixel.
    pub(super) distance_sd_m: f64,
    /// Standard error of the mean.
    pub(super) distance_error_m: f64,
    /// Mean amplitude.
    pub(super) amplitude_dn: f64,
    /// Mean amplitude over its noise.
    pub(super) signal_to_noise: f64,
    /// Pixels that were averaged.
    pub(super) pixels: f64,
    /// Distance from one side of the window to the other.
    pub(super) spread_m: f64,
}

impl Measurement {
    /// Change of the distance across the window, relative; 0 where noise explains it. The difference of two
    /// halves' means, times two, has four times the standard error of the window's mean.
    pub(super) fn tilt(&self) -> f64 {
        let significant = self.spread_m > STANDARD_ERRORS * 4.0 * self.distance_error_m;
        if significant { self.spread_m / self.distance_m } else { 0.0 }
    }

    /// Standard error of the mean amplitude, relative.
    pub(super) fn amplitude_error(&self) -> f64 {
        1.0 / (self.signal_to_noise * self.pixels.sqrt())
    }

    pub(super) fn is_reliable(&self) -> bool {
        self.distance_sd_m <= differences::DISTANCE_NOISE_SHARE * self.distance_m
    }
}

/// Means over the valid pixels of the window; `None` when too few of them are valid.
pub(super) fn measure(frame: &Frame, distances_m: &[f32], window_px: usize) -> Option<Measurement> {
    let shape = frame.shape();
    let window = Window::centred(shape, window_px);
    let valid = |i: usize| frame.is_valid(i) && distances_m[i] > 0.0 && distances_m[i].is_finite();
    let masked = |values: &[f32]| -> Vec<f64> {
        window.indices(shape).map(|i| if valid(i) { f64::from(values[i]) } else { f64::NAN }).collect()
    };
    let (amplitudes, distances) = (masked(frame.amplitude.values()), masked(distances_m));
    let count = amplitudes.iter().filter(|a| a.is_finite()).count();
    if (count as f64) < (1.0 - INVALID_SHARE) * amplitudes.len() as f64 || count == 0 {
        return None;
    }
    let mean = |values: &[f64]| values.iter().filter(|v| v.is_finite()).sum::<f64>() / count as f64;
    let deviation = |values: &[f64]| {
        // Where the noise cannot be measured, the distance counts as unreliable.
        differences::spatial(values.chunks(window.width)).unwrap_or(f64::INFINITY)
    };
    let (amplitude_dn, distance_m) = (mean(&amplitudes), mean(&distances));
    let distance_sd_m = deviation(&distances);
    Some(Measurement {
        distance_m,
        distance_sd_m,
        distance_error_m: distance_sd_m / (count as f64).sqrt(),
        amplitude_dn,
        signal_to_noise: amplitude_dn / deviation(&amplitudes),
        pixels: count as f64,
        spread_m: slope_spread(&distances, window),
    })
}

/// Distance from one side of the window to the other: difference of the halves' means times two, whichever of
/// the two directions has more. Means of halves, because single pixels are noisy.
fn slope_spread(distances: &[f64], window: Window) -> f64 {
    let half = |wanted: &dyn Fn(usize, usize) -> bool| {
        let inside = distances
            .iter()
            .enumerate()
            .filter(|(i, d)| d.is_finite() && wanted(i / window.width.max(1), i % window.width.max(1)));
        let (sum, count) = inside.fold((0.0, 0.0), |(sum, count), (_, d)| (sum + d, count + 1.0));
        sum / count
    };
    let rows = half(&|row, _| 2 * row < window.height) - half(&|row, _| 2 * row >= window.height);
    let columns =
        half(&|_, column| 2 * column < window.width) - half(&|_, column| 2 * column >= window.width);
    let spread = |difference: f64| if difference.is_finite() { 2.0 * difference.abs() } else { 0.0 };
    spread(rows).max(spread(columns))
}
