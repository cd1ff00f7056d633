//! Measuring an exposure sweep: the mean amplitude of the whole image at each integration time.

use std::collections::BTreeMap;

use super::evidence::{Collector, ResponseEvidence};
use super::noise_survey::{NoiseCells, NoiseSurvey};
use super::runs::{Place, Runs};
use super::warning::FitWarning;
use super::{CalibrateError, CalibrateSettings, noise_floor, single_time};
use crate::calibration::NoiseFloor;
use crate::frame::{Frame, PixelFlags, Window};
use crate::numerics::differences;
use crate::numerics::statistics::upper_median;
use crate::still_scene::MotionWatch;
use crate::terms::lut::{ExposureSample, Lut};
use crate::terms::{Source, root_mean_square};

/// A recording of a still scene while the integration time varies, measured frame by frame.
#[derive(Clone, Debug)]
pub struct ExposureSweep {
    recording: String,
    settings: CalibrateSettings,
    runs: Runs,
    frames: usize,
    used: usize,
    /// Keyed by the bits of the (positive) time, which order like the times.
    times: BTreeMap<u64, TimeSums>,
    pixels: Vec<PixelHistory>,
    motion: MotionWatch,
    /// Values in the central window of the previous frame, for the noise.
    previous: Option<Vec<f64>>,
    survey: NoiseSurvey,
    collector: Collector,
}

/// Sums over the frames of one integration time.
#[derive(Clone, Debug, Default)]
struct TimeSums {
    /// Per frame: sum of positive amplitudes, number of them, number of zeros, share of saturated pixels.
    frames: Vec<FrameSums>,
    noise_dn: Vec<f64>,
}

#[derive(Clone, Copy, Debug, Default)]
struct FrameSums {
    sum: f64,
    positive: usize,
    zero: usize,
    saturated: usize,
}

/// Tells a dead pixel (0 in every frame) from one that is dark or collapsed for a while.
#[derive(Clone, Copy, Debug, Default)]
struct PixelHistory {
    ever_other: bool,
}

/// What an exposure sweep says: one mean per integration time.
#[derive(Clone, Debug, PartialEq)]
pub struct ExposureCurve {
    /// The recording.
    pub source: Source,
    /// Means in the order of time.
    pub samples: Vec<ExposureSample>,
    /// Share of the pixels that carry the camera's saturation code, for each sample.
    pub saturated_share: Vec<f64>,
    /// Noise at the shortest time, where a run has two frames.
    pub noise_floor: Option<NoiseFloor>,
    /// Noise at the times up to half of the largest mean amplitude; only that of repeated frames makes a term.
    pub noise: NoiseCells,
    /// What the sweep offers for the response.
    pub evidence: ResponseEvidence,
    /// What is odd about the recording.
    pub warnings: Vec<FitWarning>,
}

impl ExposureSweep {
    /// Starts a sweep; `recording` is the name that errors and the calibration give it.
    #[must_use]
    pub fn new(recording: impl Into<String>, settings: &CalibrateSettings) -> Self {
        Self {
            recording: recording.into(),
            settings: settings.clone(),
            runs: Runs::new(settings.skip_frames),
            frames: 0,
            used: 0,
            times: BTreeMap::new(),
            pixels: Vec::new(),
            motion: MotionWatch::default(),
            previous: None,
            survey: NoiseSurvey::new(),
            collector: Collector::new(),
        }
    }

    /// Measures the next frame.
    ///
    /// # Errors
    /// [`CalibrateError`] when the frame has no single known integration time, or planes that do not fit.
    pub fn push(&mut self, frame: &Frame) -> Result<(), CalibrateError> {
        let number = self.frames;
        frame.check_shapes().map_err(|source| CalibrateError::Shape { frame: number, source })?;
        let time_us = single_time(&frame.integration_time_us)
            .map_err(|found| CalibrateError::NoSingleTime { frame: number, found })?;
        self.frames += 1;
        let place = self.runs.push(time_us);
        if place == Place::Settling || self.settings.excludes(time_us) {
            self.previous = None;
            self.survey.interrupt();
            return Ok(());
        }
        self.used += 1;
        self.pixels.resize(frame.shape().pixels(), PixelHistory::default());
        let sums = self.sum(frame);
        let window = window_values(frame);
        let noise = match (&self.previous, place) {
            (Some(previous), Place::Later) => differences::temporal(previous, &window),
            _ => None,
        };
        self.previous = Some(window);
        self.survey.push(frame);
        let time = self.times.entry(time_us.to_bits()).or_default();
        time.frames.push(sums);
        time.noise_dn.extend(noise);
        self.collector.push(time_us, frame, place == Place::First);
        if place == Place::First {
            self.motion.push(time_us, frame);
        }
        Ok(())
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

    /// Ends the sweep.
    ///
    /// A pixel that is 0 at some times only (too dark, or collapsed by over-saturation) counts as 0 there: to
    /// leave it out would change which pixels are averaged, and bend the curve. Dead pixels never count.
    #[must_use]
    pub fn finish(self) -> ExposureCurve {
        let dead = self.pixels.iter().filter(|pixel| !pixel.ever_other).count();
        let pixels = self.pixels.len().max(1) as f64;
        let mut warnings = Vec::new();
        let (mut samples, mut saturated_share) = (Vec::new(), Vec::new());
        for (&bits, sums) in &self.times {
            if sums.frames.iter().any(|frame| frame.count(dead) == 0) {
                let integration_time_us = f64::from_bits(bits);
                warnings.push(FitWarning::NoMeasurement {
                    recording: self.recording.clone(),
                    integration_time_us,
                });
                continue;
            }
            samples.push(sums.sample(f64::from_bits(bits), dead));
            let saturated = sums.frames.iter().map(|f| f.saturated as f64).sum::<f64>();
            saturated_share.push(saturated / pixels / sums.frames.len() as f64);
        }
        if self.runs.decreased {
            warnings.push(FitWarning::TimesNotIncreasing { recording: self.recording.clone() });
        }
        warnings.extend(self.motion.verdict().map(|movement| FitWarning::SceneMoved {
            recording: self.recording.clone(),
            integration_time_us: movement.integration_time_us,
            share: movement.share,
        }));
        warnings.extend(settling(&self.recording, self.times.values(), dead));
        let floor = self.times.iter().next().and_then(|(&bits, sums)| {
            let mean = sums.noise_dn.iter().sum::<f64>() / sums.noise_dn.len() as f64;
            noise_floor(Some(mean), f64::from_bits(bits))
        });
        let mut noise = self.survey.finish();
        noise.up_to(nearly_linear_up_to(&samples));
        let frames_left_out = self.frames - self.used;
        let source = Source { recording: self.recording, frames_used: self.used, frames_left_out };
        let evidence = self.collector.finish();
        ExposureCurve { source, samples, saturated_share, noise_floor: floor, noise, evidence, warnings }
    }
}

/// The longest time before the mean amplitude exceeds half of its largest value, µs: a full well compresses the noise
/// with the amplitude, by less than a tenth down there.
fn nearly_linear_up_to(samples: &[ExposureSample]) -> f64 {
    let largest = samples.iter().map(|sample| sample.mean_amplitude_dn).fold(0.0, f64::max);
    let below = samples.iter().take_while(|sample| sample.mean_amplitude_dn <= 0.5 * largest);
    below.last().map_or(0.0, |sample| sample.integration_time_us)
}

impl TimeSums {
    fn sample(&self, integration_time_us: f64, dead: usize) -> ExposureSample {
        let means: Vec<f64> = self.frames.iter().map(|frame| frame.mean(dead)).collect();
        let mean = means.iter().sum::<f64>() / means.len() as f64;
        let spread = root_mean_square(means.iter().map(|m| m / mean - 1.0)).unwrap_or(0.0);
        ExposureSample { integration_time_us, mean_amplitude_dn: mean, frame_spread: spread }
    }
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

/// The camera settles when, in most runs, the first frames differ from the last by more than this share.
const SETTLING_SHARE: f64 = 0.005;

fn settling<'a>(
    recording: &str,
    times: impl Iterator<Item = &'a TimeSums>,
    dead: usize,
) -> Option<FitWarning> {
    let drift = |sums: &TimeSums| match sums.frames.as_slice() {
        [first, .., last] => Some(first.mean(dead) / last.mean(dead) - 1.0),
        _ => None,
    };
    let mut drifts: Vec<f64> = times.filter_map(drift).collect();
    let median = upper_median(&mut drifts)?;
    (median.abs() > SETTLING_SHARE)
        .then(|| FitWarning::Settling { recording: recording.to_owned(), relative_drift: median })
}

impl ExposureCurve {
    /// Shares of saturated pixels above this bend the mean, since their codes cannot be averaged.
    const SATURATED_SHARE: f64 = 0.005;
    /// A table with fewer times interpolates over more than its shape tells.
    const ENOUGH_TIMES: usize = 8;

    /// What the user should know of the table that was fitted on this curve.
    pub(super) fn warnings_for(&self, lut: &Lut) -> Vec<FitWarning> {
        let recording = || self.source.recording.clone();
        let mut warnings = self.warnings.clone();
        let found = lut.integration_time_us.len();
        if found < Self::ENOUGH_TIMES {
            warnings.push(FitWarning::TooFewTimes { recording: recording(), found });
        }
        let last = lut.valid_integration_time_us[1];
        let used =
            self.samples.iter().zip(&self.saturated_share).filter(|(s, _)| s.integration_time_us <= last);
        let first_saturated = used.clone().find(|(_, share)| **share > Self::SATURATED_SHARE);
        if let Some((sample, _)) = first_saturated {
            let share = used.map(|(_, share)| *share).fold(0.0, f64::max);
            let from_us = sample.integration_time_us;
            warnings.push(FitWarning::SaturationInSweep { recording: recording(), from_us, share });
        }
        warnings
    }
}

/// Amplitudes of the central 64×64 pixels, NaN where invalid: enough for a noise figure of 1 %.
fn window_values(frame: &Frame) -> Vec<f64> {
    let shape = frame.shape();
    let value = |i: usize| if frame.is_valid(i) { f64::from(frame.amplitude.values()[i]) } else { f64::NAN };
    Window::centred(shape, 64).indices(shape).map(value).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::{IntegrationTime, Shape};

    fn frame(time_us: f64, amplitudes: &[f32]) -> Frame {
        let mut frame = Frame::new(Shape::new(1, amplitudes.len()));
        frame.amplitude.values_mut().copy_from_slice(amplitudes);
        frame.integration_time_us = IntegrationTime::PerFrame(time_us);
        frame.flag_amplitude(Some(1000.0));
        frame
    }

    fn curve(settings: &CalibrateSettings, frames: &[Frame]) -> ExposureCurve {
        let mut sweep = ExposureSweep::new("wall", settings);
        frames.iter().try_for_each(|frame| sweep.push(frame)).unwrap();
        sweep.finish()
    }

    #[test]
    fn dead_and_invalid_pixels_never_count_and_collapsed_ones_count_as_zero() {
        let frames = [
            frame(100.0, &[0.0, 2.0, 4.0, f32::NAN, f32::NAN]),
            frame(200.0, &[0.0, 4.0, 8.0, 6.0, f32::NAN]),
            frame(300.0, &[0.0, 6.0, 0.0, 1000.0, f32::NAN]),
        ];
        let curve = curve(&CalibrateSettings::default(), &frames);
        let means: Vec<f64> = curve.samples.iter().map(|s| s.mean_amplitude_dn).collect();
        assert_eq!(means, [3.0, 6.0, 3.0]);
        assert_eq!(curve.saturated_share, [0.0, 0.0, 0.2]);
    }

    #[test]
    fn settling_frames_and_excluded_times_are_left_out() {
        let settings =
            CalibrateSettings { skip_frames: 1, exclude_time_us: vec![300.0], ..Default::default() };
        let frames = [1.0, 2.0, 3.0].map(|v| frame(100.0, &[v])).into_iter();
        let frames: Vec<Frame> = frames.chain([frame(300.0, &[9.0]), frame(300.0, &[9.0])]).collect();
        let curve = curve(&settings, &frames);
        assert_eq!(curve.samples.len(), 1);
        assert_eq!(curve.samples[0].mean_amplitude_dn, 2.5);
        assert_eq!((curve.source.frames_used, curve.source.frames_left_out), (2, 3));
    }

    #[test]
    fn a_time_at_which_every_pixel_is_saturated_is_left_out() {
        let frames = [(100.0, 9.0), (200.0, 18.0), (300.0, 1000.0)].map(|(t, v)| frame(t, &[v, v]));
        let curve = curve(&CalibrateSettings::default(), &frames);
        assert_eq!(curve.samples.len(), 2);
        assert!(matches!(curve.warnings[..], [FitWarning::NoMeasurement { integration_time_us: 300.0, .. }]));
    }

    #[test]
    fn a_sweep_downwards_and_a_drift_are_reported() {
        let frames: Vec<Frame> =
            [(200.0, 4.0), (200.0, 3.9), (100.0, 2.0), (100.0, 1.95)].map(|(t, v)| frame(t, &[v])).into();
        let warnings = curve(&CalibrateSettings::default(), &frames).warnings;
        assert!(matches!(warnings[0], FitWarning::TimesNotIncreasing { .. }));
        assert!(matches!(warnings[1], FitWarning::Settling { relative_drift, .. } if relative_drift > 0.02));
    }

    #[test]
    fn frames_without_a_single_time_are_refused_by_number() {
        let mut sweep = ExposureSweep::new("wall", &CalibrateSettings::default());
        sweep.push(&frame(100.0, &[1.0])).unwrap();
        let mut unknown = frame(100.0, &[1.0]);
        unknown.integration_time_us = IntegrationTime::Unknown;
        let error = sweep.push(&unknown).unwrap_err();
        assert_eq!(error, CalibrateError::NoSingleTime { frame: 1, found: "unknown" });
    }
}
