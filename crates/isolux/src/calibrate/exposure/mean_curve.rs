//! The mean amplitude of the whole image at each integration time.

use super::frame_sums::{FrameSums, Times};
use super::{moved, stray};
use crate::calibrate::blocks::blocks;
use crate::calibrate::stray::Stray;
use crate::frame::{Frame, PixelFlags};
use crate::terms::lut::ExposureSample;
use crate::terms::root_mean_square;

/// Sums up amplitudes, frame by frame.
#[derive(Clone, Debug, Default)]
pub(super) struct MeanCurve {
    /// Frames of each time, keyed by the bits of the (positive) time, which order like the times.
    times: Times,
    pixels: Vec<PixelHistory>,
}

/// Distinguishes dead pixels (0 in every frame) from pixels that are dark or over-saturated in some frames.
#[derive(Clone, Copy, Debug, Default)]
struct PixelHistory {
    ever_other: bool,
}

/// What was left out of a sweep.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Cleaned {
    pub(super) stray: Option<Stray>,
    pub(super) moved: Option<moved::Moved>,
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
    /// Takes the frame of this number.
    pub(super) fn push(&mut self, number: usize, time_us: f64, frame: &Frame) {
        self.pixels.resize(frame.shape().pixels(), PixelHistory::default());
        let sums = FrameSums { number, blocks: blocks(frame), ..self.sum(frame) };
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

    /// Leaves out frames and parts of the image that show something else than the rest of the sweep.
    pub(super) fn clean(&mut self) -> Cleaned {
        let dead = self.dead();
        let stray = stray::leave_out(&mut self.times, dead);
        let moved = moved::fill_in(&mut self.times);
        Cleaned { stray, moved }
    }

    /// The frames.
    pub(super) fn times(&self) -> &Times {
        &self.times
    }

    /// Number of pixels that are 0 in every frame.
    pub(super) fn dead(&self) -> usize {
        self.pixels.iter().filter(|pixel| !pixel.ever_other).count()
    }

    /// The means of all times.
    ///
    /// A pixel that is 0 at some times only (too dark or over-saturated) counts as 0 there: without it, the mean
    /// would be over other pixels, which would distort the curve. Dead pixels never count.
    pub(super) fn means(&self) -> Means {
        let dead = self.dead();
        let pixels = self.pixels.len().max(1) as f64;
        let mut means = Means { drift: drift(self.times.values(), dead), ..Means::default() };
        for (&bits, frames) in &self.times {
            let time_us = f64::from_bits(bits);
            let frames: Vec<&FrameSums> = frames.iter().filter(|frame| !frame.stray).collect();
            if frames.is_empty() {
                continue;
            }
            if frames.iter().any(|frame| frame.count(dead) == 0) {
                means.without_measurement_us.push(time_us);
                continue;
            }
            means.samples.push(sample(time_us, &frames, dead));
            let saturated = frames.iter().map(|f| f.saturated as f64).sum::<f64>();
            means.saturated_share.push(saturated / pixels / frames.len() as f64);
        }
        means
    }
}

fn sample(integration_time_us: f64, frames: &[&FrameSums], dead: usize) -> ExposureSample {
    let means: Vec<f64> = frames.iter().map(|frame| frame.mean(dead)).collect();
    let mean = means.iter().sum::<f64>() / means.len() as f64;
    let spread = root_mean_square(means.iter().map(|m| m / mean - 1.0)).unwrap_or(0.0);
    ExposureSample { integration_time_us, mean_amplitude_dn: mean, frame_spread: spread }
}

fn drift<'a>(times: impl Iterator<Item = &'a Vec<FrameSums>>, dead: usize) -> Option<f64> {
    let kept = |frames: &'a Vec<FrameSums>| -> Vec<&'a FrameSums> {
        frames.iter().filter(|frame| !frame.stray).collect()
    };
    let drift = |frames: &'a Vec<FrameSums>| match kept(frames).as_slice() {
        [first, .., last] => Some(first.mean(dead) / last.mean(dead) - 1.0),
        _ => None,
    };
    let mut drifts: Vec<f64> = times.filter_map(drift).collect();
    drifts.sort_by(f64::total_cmp);
    drifts.get(drifts.len() / 2).copied()
}
