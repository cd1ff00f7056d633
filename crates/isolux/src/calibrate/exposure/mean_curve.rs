//! The mean amplitude of the whole image at each integration time.

use std::collections::BTreeMap;

use crate::frame::{Frame, PixelFlags};
use crate::terms::lut::ExposureSample;
use crate::terms::root_mean_square;

/// Sums up amplitudes, frame by frame.
#[derive(Clone, Debug, Default)]
pub(super) struct MeanCurve {
    /// Frames of each time, keyed by the bits of the (positive) time, which order like the times.
    times: BTreeMap<u64, Vec<FrameSums>>,
    pixels: Vec<PixelHistory>,
}

/// Sum and number of the positive amplitudes of a frame, and the numbers of zeros and of saturated pixels.
#[derive(Clone, Copy, Debug, Default)]
struct FrameSums {
    sum: f64,
    positive: usize,
    zero: usize,
    saturated: usize,
}

/// Distinguishes dead pixels (0 in every frame) from pixels that are dark or over-saturated in some frames.
#[derive(Clone, Copy, Debug, Default)]
struct PixelHistory {
    ever_other: bool,
}

/// The means of all frames.
#[derive(Clone, Debug, Default)]
pub(super) struct Means {
    /// By increasing time.
    pub(super) samples: Vec<ExposureSample>,
    /// Share of the pixels that carry the camera's saturation code, for each sample.
    pub(super) saturated_share: Vec<f64>,
    /// Times at which a frame has no pixel with a value, µs.
    pub(super) without_measurement_us: Vec<f64>,
    /// Relative difference of the first frame of a run from the last, median over the times with two frames or
    /// more.
    pub(super) drift: Option<f64>,
}

impl MeanCurve {
    /// Takes the next frame.
    pub(super) fn push(&mut self, time_us: f64, frame: &Frame) {
        self.pixels.resize(frame.shape().pixels(), PixelHistory::default());
        let sums = self.sum(frame);
        self.times.entry(time_us.to_bits()).or_default().push(sums);
    }

    fn sum(&mut self, frame: &Frame) -> FrameSums {
        let mut sums = FrameSums::default();
        let pixels = frame.amplitude.values().iter().zip(frame.flags.values()).zip(&mut self.pixels);
        for ((&amplitude, flags), history) in pixels {
            if !flags.contains(PixelFlags::INVALID) {
                sums.sum += f64::from(amplitude);
                sums.positive += 1;
                history.ever_other = true;
            } else if flags.contains(PixelFlags::SATURATED) {
                sums.saturated += 1;
                history.ever_other = true;
            } else if amplitude == 0.0 {
                sums.zero += 1;
            } else {
                history.ever_other = true;
            }
        }
        sums
    }

    /// The means of all times.
    ///
    /// A pixel that is 0 at some times only (too dark or over-saturated) counts as 0 there: without it, the mean
    /// would be over other pixels, which would distort the curve. Dead pixels never count.
    pub(super) fn means(&self) -> Means {
        let dead = self.pixels.iter().filter(|pixel| !pixel.ever_other).count();
        let pixels = self.pixels.len().max(1) as f64;
        let mut means = Means { drift: drift(self.times.values(), dead), ..Means::default() };
        for (&bits, frames) in &self.times {
            let time_us = f64::from_bits(bits);
            if frames.iter().any(|frame| frame.count(dead) == 0) {
                means.without_measurement_us.push(time_us);
                continue;
            }
            means.samples.push(sample(time_us, frames, dead));
            let saturated = frames.iter().map(|f| f.saturated as f64).sum::<f64>();
            means.saturated_share.push(saturated / pixels / frames.len() as f64);
        }
        means
    }
}

fn sample(integration_time_us: f64, frames: &[FrameSums], dead: usize) -> ExposureSample {
    let means: Vec<f64> = frames.iter().map(|frame| frame.mean(dead)).collect();
    let mean = means.iter().sum::<f64>() / means.len() as f64;
    let spread = root_mean_square(means.iter().map(|m| m / mean - 1.0)).unwrap_or(0.0);
    ExposureSample { integration_time_us, mean_amplitude_dn: mean, frame_spread: spread }
}

fn drift<'a>(times: impl Iterator<Item = &'a Vec<FrameSums>>, dead: usize) -> Option<f64> {
    let drift = |frames: &Vec<FrameSums>| match frames.as_slice() {
        [first, .., last] => Some(first.mean(dead) / last.mean(dead) - 1.0),
        _ => None,
    };
    let mut drifts: Vec<f64> = times.filter_map(drift).collect();
    drifts.sort_by(f64::total_cmp);
    drifts.get(drifts.len() / 2).copied()
}

impl FrameSums {
    /// Pixels that enter the mean.
    fn count(&self, dead: usize) -> usize {
        self.positive + self.zero.saturating_sub(dead)
    }

    fn mean(&self, dead: usize) -> f64 {
        self.sum / self.count(dead) as f64
    }
}
