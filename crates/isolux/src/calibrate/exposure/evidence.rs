//! What the response is fitted to: the mean amplitude of every pixel at each time, and all channels of a sample of
//! pixels.

use std::collections::BTreeMap;

use crate::calibrate::blocks::block_of;
use crate::frame::{Frame, PixelFlags, Shape};
use crate::terms::response::{AmplitudeStack, PixelMeans, PixelSeries};

/// What an exposure sweep measured for the fit of the response.
#[derive(Clone, Debug, PartialEq)]
pub struct ResponseEvidence {
    /// Mean amplitude of each pixel at each time, DN; NaN where the pixel was invalid or saturated in any frame. A
    /// long sweep keeps every second time, or fewer, to limit the memory.
    pub(crate) stack: AmplitudeStack,
    /// All channels of some pixels, spread over the image.
    pub(crate) pixels: Vec<PixelSeries>,
}

/// Largest number of amplitudes in the stack, 64 MiB. While it grows, it takes three times that for a moment.
const STACK_VALUES: usize = 16 << 20;
/// Number of pixels of which all channels are kept.
const SAMPLED_PIXELS: usize = 256;

/// Collects [`ResponseEvidence`] frame by frame. The frames of a run of one time are averaged into one image.
#[derive(Clone, Debug)]
pub(super) struct Collector {
    stack: AmplitudeStack,
    pixels: Vec<PixelSeries>,
    /// Frames of each image of the stack, and of each value of the pixels.
    stack_frames: Vec<Vec<usize>>,
    pixel_frames: Vec<Vec<usize>>,
    /// Every `stride`-th run enters the stack.
    stride: usize,
    runs: usize,
    run: Option<Run>,
}

/// Frames of a run whose total amplitudes differ by more than this share are not averaged: one of them may turn out to
/// be a stray one.
const LIKE_SHARE: f64 = 0.05;

/// Sums over the frames of the current run.
#[derive(Clone, Debug)]
struct Run {
    integration_time_us: f64,
    frames: f64,
    numbers: Vec<usize>,
    /// Total amplitude of the last frame.
    total: f64,
    /// NaN after a frame without a value.
    amplitudes: Vec<f64>,
    sampled: Vec<PixelMeans>,
}

impl Collector {
    pub(super) fn new() -> Self {
        let stack = AmplitudeStack::new(Shape::new(0, 0));
        Self {
            stack,
            pixels: Vec::new(),
            stack_frames: Vec::new(),
            pixel_frames: Vec::new(),
            stride: 1,
            runs: 0,
            run: None,
        }
    }

    /// Takes the frame of this number; `first` opens a run.
    pub(super) fn push(&mut self, number: usize, integration_time_us: f64, frame: &Frame, first: bool) {
        let pixels = frame.shape().pixels();
        let total = total(frame);
        let continues = |run: &Run| {
            run.amplitudes.len() == pixels && (total - run.total).abs() <= LIKE_SHARE * total.max(run.total)
        };
        if first || !self.run.as_ref().is_some_and(continues) {
            self.close_run();
            if self.stack.shape() != frame.shape() {
                // The frames of a recording have one shape, those of other callers need not.
                self.stack = AmplitudeStack::new(frame.shape());
                self.pixels = vec![PixelSeries::new(); sampled(pixels).count()];
                (self.stack_frames, self.pixel_frames) = (Vec::new(), Vec::new());
            }
            self.run = Some(Run::new(integration_time_us, pixels));
        }
        if let Some(run) = &mut self.run {
            run.add(frame);
            run.numbers.push(number);
            run.total = total;
        }
    }

    fn close_run(&mut self) {
        let Some(run) = self.run.take() else { return };
        let frames = run.frames;
        if self.runs.is_multiple_of(self.stride) {
            let means = run.amplitudes.iter().map(|sum| (sum / frames) as f32);
            self.stack.push(run.integration_time_us, means);
            self.stack_frames.push(run.numbers.clone());
            if self.stack.integration_time_us().len() * self.stack.shape().pixels() > STACK_VALUES {
                self.stack.thin_out();
                let mut kept = (0..self.stack_frames.len()).map(|index| index.is_multiple_of(2));
                self.stack_frames.retain(|_| kept.next().unwrap_or(false));
                self.stride *= 2;
            }
        }
        self.runs += 1;
        self.pixel_frames.push(run.numbers);
        for (series, sums) in self.pixels.iter_mut().zip(run.sampled) {
            series.push(PixelMeans {
                amplitude_dn: sums.amplitude_dn / frames,
                intensity_dn: sums.intensity_dn / frames,
                phase_samples_dn: sums.phase_samples_dn.map(|sum| sum / frames),
                ..sums
            });
        }
    }

    /// The evidence without the `stray` frames, and without the blocks that moved in any frame of a run.
    pub(super) fn finish(mut self, stray: &[usize], moved: &BTreeMap<usize, &[usize]>) -> ResponseEvidence {
        self.close_run();
        let shape = self.stack.shape();
        let excluded = |frames: &[usize], pixel: usize| {
            let block = block_of(pixel, shape.height, shape.width);
            frames.iter().any(|frame| moved.get(frame).is_some_and(|blocks| blocks.contains(&block)))
        };
        let is_stray = |frames: &[usize]| frames.iter().any(|frame| stray.contains(frame));
        for (image, frames) in self.stack_frames.iter().enumerate() {
            if frames.iter().any(|frame| moved.get(frame).is_some_and(|blocks| !blocks.is_empty())) {
                self.stack.exclude(image, |pixel| excluded(frames, pixel));
            }
        }
        self.stack.retain(|image| !is_stray(&self.stack_frames[image]));
        for (series, pixel) in self.pixels.iter_mut().zip(sampled(shape.pixels())) {
            let mut frames = self.pixel_frames.iter();
            series.retain(|_| {
                frames.next().is_some_and(|frames| !is_stray(frames) && !excluded(frames, pixel))
            });
        }
        for series in &mut self.pixels {
            series.sort_by(|a, b| a.integration_time_us.total_cmp(&b.integration_time_us));
        }
        ResponseEvidence { stack: self.stack, pixels: self.pixels }
    }
}

impl Run {
    fn new(integration_time_us: f64, pixels: usize) -> Self {
        let nothing = PixelMeans {
            integration_time_us,
            amplitude_dn: 0.0,
            intensity_dn: 0.0,
            phase_samples_dn: [0.0; 4],
            unusable: false,
        };
        let sampled = vec![nothing; sampled(pixels).count()];
        Self {
            integration_time_us,
            frames: 0.0,
            numbers: Vec::new(),
            total: 0.0,
            amplitudes: vec![0.0; pixels],
            sampled,
        }
    }

    fn add(&mut self, frame: &Frame) {
        let unusable = PixelFlags::INVALID | PixelFlags::SATURATED;
        self.frames += 1.0;
        for (sum, amplitude) in self.amplitudes.iter_mut().zip(frame.counted_amplitudes()) {
            *sum += f64::from(amplitude);
        }
        let pixels = frame.shape().pixels();
        for (sums, index) in self.sampled.iter_mut().zip(sampled(pixels)) {
            let flags = frame.flags.values()[index];
            // A saturation code is no amplitude, but the 0 of an over-saturated pixel is.
            let code = flags.contains(unusable);
            let amplitude = frame.amplitude.values()[index];
            sums.amplitude_dn += if code { f64::NAN } else { f64::from(amplitude) };
            sums.intensity_dn += frame.intensity.as_ref().map_or(f64::NAN, |i| f64::from(i.values()[index]));
            for (bin, sum) in sums.phase_samples_dn.iter_mut().enumerate() {
                let bins = frame.phase_samples.as_ref();
                *sum += bins.map_or(f64::NAN, |bins| f64::from(bins[bin].values()[index]));
            }
            sums.unusable |= flags.intersects(unusable);
        }
    }
}

/// Sum of the valid amplitudes, DN.
fn total(frame: &Frame) -> f64 {
    let values = frame.amplitude.values().iter().enumerate();
    values.filter(|(index, _)| frame.is_valid(*index)).map(|(_, value)| f64::from(*value)).sum()
}

/// Indices of the sampled pixels: evenly spread, with a step of which no usual image width is a multiple.
fn sampled(pixels: usize) -> impl Iterator<Item = usize> {
    let step = (pixels / SAMPLED_PIXELS).max(1) | 1;
    (step / 2..pixels).step_by(step)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::Plane;

    #[test]
    fn a_run_is_one_image_and_what_is_invalid_once_has_no_mean() {
        let mut collector = Collector::new();
        for (time_us, first, values) in
            [(1.0, true, [200.0, 5.0]), (1.0, false, [206.0, 0.0]), (2.0, true, [6.0, 7.0])]
        {
            let mut frame = Frame::new(Shape::new(1, 2));
            frame.amplitude.values_mut().copy_from_slice(&values);
            frame.intensity = Some(Plane::filled(Shape::new(1, 2), 9.0));
            frame.flag_amplitude(None);
            collector.push(0, time_us, &frame, first);
        }
        let evidence = collector.finish(&[], &BTreeMap::new());
        let mut expected = AmplitudeStack::new(Shape::new(1, 2));
        expected.push(1.0, [203.0, f32::NAN]);
        expected.push(2.0, [6.0, 7.0]);
        assert_eq!(format!("{:?}", evidence.stack), format!("{expected:?}"));
        let means = evidence.pixels[1][0];
        assert_eq!((means.amplitude_dn, means.intensity_dn, means.unusable), (2.5, 9.0, true));
        assert!(means.phase_samples_dn[0].is_nan());
    }

    #[test]
    fn stray_frames_and_parts_that_moved_are_left_out() {
        let mut collector = Collector::new();
        for (number, value) in [100.0, 0.5, 101.0, 100.0].into_iter().enumerate() {
            let mut frame = Frame::new(Shape::new(1, 2));
            frame.amplitude.fill(value);
            frame.flag_amplitude(None);
            collector.push(number, 1.0 + (number / 3) as f64, &frame, number % 3 == 0);
        }
        // Of two columns, the first lies in the first block, the second in the one in the middle.
        let moved = BTreeMap::from([(3, &[0usize][..])]);
        let evidence = collector.finish(&[1], &moved);
        let mut expected = AmplitudeStack::new(Shape::new(1, 2));
        expected.push(1.0, [100.0, 100.0]);
        expected.push(1.0, [101.0, 101.0]);
        expected.push(2.0, [f32::NAN, 100.0]);
        assert_eq!(format!("{:?}", evidence.stack), format!("{expected:?}"));
        assert_eq!(evidence.pixels.iter().map(Vec::len).collect::<Vec<_>>(), [2, 3]);
    }
}
