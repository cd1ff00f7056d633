//! Measures an exposure sweep: a recording of a still scene at several integration times.

use super::ExposureWarning;
use super::evidence::{Collector, ResponseEvidence};
use super::faults::faults;
use super::floor::FloorWatch;
use super::frame_sums::FrameSums;
use super::mean_curve::{MeanCurve, Means};
use super::noise_survey::{NoiseCells, NoiseSurvey};
use crate::calibrate::drift::DriftWatch;
use crate::calibrate::runs::Place;
use crate::calibrate::sweep_fault::SweepFault;
use crate::calibrate::sweep_frames::{SweepFrames, single_time};
use crate::calibrate::{CalibrateSettings, MeasureError};
use crate::calibration::NoiseFloor;
use crate::frame::Frame;
use crate::still_scene::MotionWatch;
use crate::terms::lut::ExposureSample;
use crate::terms::{Lut, Source};

/// The camera settles when, in most runs, the first frames differ from the last by more than this share.
const SETTLING_SHARE: f64 = 0.005;

/// A recording of a still scene while the integration time varies, measured frame by frame.
#[derive(Clone, Debug)]
pub struct ExposureSweep {
    frames: SweepFrames,
    used: usize,
    curve: MeanCurve,
    floor: FloorWatch,
    survey: NoiseSurvey,
    collector: Collector,
    motion: MotionWatch,
    drift: DriftWatch,
}

/// The result of an exposure sweep: one mean per integration time, and what response and noise are fitted to.
#[derive(Clone, Debug, PartialEq)]
pub struct ExposureCurve {
    /// The recording.
    pub source: Source,
    /// Mean amplitudes by increasing time.
    pub samples: Vec<ExposureSample>,
    /// Share of the pixels that carry the camera's saturation code, for each sample.
    pub saturated_share: Vec<f64>,
    /// Noise at the shortest time; `None` unless a run of it has two frames.
    pub noise_floor: Option<NoiseFloor>,
    /// Noise at the times up to half of the largest mean amplitude. Only the noise of repeated frames becomes a
    /// term.
    pub noise: NoiseCells,
    /// What the response is fitted to.
    pub evidence: ResponseEvidence,
    /// Warnings about the recording.
    pub warnings: Vec<ExposureWarning>,
}

impl ExposureSweep {
    /// Starts a sweep; `recording` is its name in errors and in the calibration.
    #[must_use]
    pub fn new(recording: impl Into<String>, settings: &CalibrateSettings) -> Self {
        Self {
            frames: SweepFrames::new(recording, settings),
            used: 0,
            curve: MeanCurve::default(),
            floor: FloorWatch::default(),
            survey: NoiseSurvey::new(),
            collector: Collector::new(),
            motion: MotionWatch::default(),
            drift: DriftWatch::default(),
        }
    }

    /// Measures the next frame.
    ///
    /// # Errors
    /// [`MeasureError`] when the frame has no single known integration time, or planes of different shapes.
    pub fn push(&mut self, frame: &Frame) -> Result<(), MeasureError> {
        let number = self.frames.next(frame)?;
        let time_us = single_time(&frame.integration_time_us)
            .map_err(|found| MeasureError::NoSingleTime { frame: number, found })?;
        let Some(place) = self.frames.place(time_us) else {
            self.floor.interrupt();
            self.survey.interrupt();
            return Ok(());
        };
        let first = place == Place::First;
        self.used += 1;
        self.curve.push(number, time_us, frame);
        self.floor.push(number, time_us, frame, first);
        self.survey.push(frame);
        self.collector.push(number, time_us, frame, first);
        self.drift.push(number, frame, !first);
        if first {
            self.motion.push(time_us, frame);
        }
        Ok(())
    }

    /// Ends the sweep and computes its result.
    #[must_use]
    pub fn finish(mut self) -> ExposureCurve {
        let recording = self.frames.recording.clone();
        let noise_dn = self.floor.floor(&[]).map(|floor| floor.amplitude_sd_dn);
        let faults = faults(&recording, &mut self.curve, &self.drift, noise_dn);
        let means = self.curve.means();
        let warnings = self.warnings(&means, faults);
        let Means { samples, saturated_share, .. } = means;
        let mut noise = self.survey.finish();
        noise.up_to(nearly_linear_up_to(&samples));
        let left_out: Vec<&FrameSums> = self.curve.times().values().flatten().collect();
        let stray: Vec<usize> =
            left_out.iter().filter(|frame| frame.stray).map(|frame| frame.number).collect();
        let moved = left_out.iter().map(|frame| (frame.number, frame.moved.as_slice()));
        ExposureCurve {
            source: self.frames.source(self.used - stray.len()),
            samples,
            saturated_share,
            noise_floor: self.floor.floor(&stray),
            noise,
            evidence: self.collector.finish(&stray, &moved.collect()),
            warnings,
        }
    }

    fn warnings(&self, means: &Means, faults: Vec<SweepFault>) -> Vec<ExposureWarning> {
        let recording = || self.frames.recording.clone();
        let without = means.without_measurement_us.iter().map(|&integration_time_us| {
            ExposureWarning::NoMeasurement { recording: recording(), integration_time_us }
        });
        let mut warnings: Vec<ExposureWarning> = without.collect();
        if self.frames.times_decreased() {
            warnings.push(ExposureWarning::TimesNotIncreasing { recording: recording() });
        }
        if self.curve.times().values().all(|frames| frames.len() == 1) {
            warnings.push(ExposureWarning::NoRepeats { recording: recording() });
        }
        // What moved for a moment is left out, and with times that lag nothing is known about movement.
        let explained =
            |fault: &SweepFault| matches!(fault, SweepFault::PartsMoved { .. } | SweepFault::TimesLag { .. });
        let movement = self.motion.verdict().filter(|_| !faults.iter().any(explained));
        warnings.extend(movement.map(|movement| ExposureWarning::SceneMoved {
            recording: recording(),
            integration_time_us: movement.integration_time_us,
            share: movement.share,
        }));
        warnings.extend(faults.into_iter().map(ExposureWarning::Fault));
        let drift = means.drift.filter(|drift| drift.abs() > SETTLING_SHARE);
        warnings.extend(
            drift.map(|relative_drift| ExposureWarning::Settling { recording: recording(), relative_drift }),
        );
        warnings
    }
}

/// The longest time before the mean amplitude exceeds half of its largest value, µs. Saturation reduces the noise
/// together with the amplitude; up to that time by less than a tenth.
fn nearly_linear_up_to(samples: &[ExposureSample]) -> f64 {
    let largest = samples.iter().map(|sample| sample.mean_amplitude_dn).fold(0.0, f64::max);
    let below = samples.iter().take_while(|sample| sample.mean_amplitude_dn <= 0.5 * largest);
    below.last().map_or(0.0, |sample| sample.integration_time_us)
}

impl ExposureCurve {
    /// A larger share of saturated pixels distorts the mean, because their codes cannot be averaged.
    const SATURATED_SHARE: f64 = 0.005;
    /// With fewer times, the table interpolates over too large steps.
    const ENOUGH_TIMES: usize = 8;

    /// Warnings about the table that was fitted to this curve.
    pub(super) fn warnings_for(&self, lut: &Lut) -> Vec<ExposureWarning> {
        let recording = || self.source.recording.clone();
        let mut warnings = self.warnings.clone();
        let found = lut.integration_time_us.len();
        if found < Self::ENOUGH_TIMES {
            warnings.push(ExposureWarning::TooFewTimes { recording: recording(), found });
        }
        let last = lut.valid_integration_time_us[1];
        let used =
            self.samples.iter().zip(&self.saturated_share).filter(|(s, _)| s.integration_time_us <= last);
        let first_saturated = used.clone().find(|(_, share)| **share > Self::SATURATED_SHARE);
        if let Some((sample, _)) = first_saturated {
            let share = used.map(|(_, share)| *share).fold(0.0, f64::max);
            let from_us = sample.integration_time_us;
            warnings.push(ExposureWarning::Saturation { recording: recording(), from_us, share });
        }
        warnings
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::IntegrationTime;
    use crate::frame::Shape;

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
        assert!(matches!(
            curve.warnings[..],
            [
                ExposureWarning::NoMeasurement { integration_time_us: 300.0, .. },
                ExposureWarning::NoRepeats { .. }
            ]
        ));
    }

    #[test]
    fn a_sweep_downwards_and_a_drift_are_reported() {
        let frames: Vec<Frame> =
            [(200.0, 4.0), (200.0, 3.9), (100.0, 2.0), (100.0, 1.95)].map(|(t, v)| frame(t, &[v])).into();
        let warnings = curve(&CalibrateSettings::default(), &frames).warnings;
        assert!(matches!(warnings[0], ExposureWarning::TimesNotIncreasing { .. }));
        assert!(
            matches!(warnings[1], ExposureWarning::Settling { relative_drift, .. } if relative_drift > 0.02)
        );
    }

    #[test]
    fn frames_without_a_single_time_are_refused_by_number() {
        let mut sweep = ExposureSweep::new("wall", &CalibrateSettings::default());
        sweep.push(&frame(100.0, &[1.0])).unwrap();
        let mut unknown = frame(100.0, &[1.0]);
        unknown.integration_time_us = IntegrationTime::Unknown;
        let error = sweep.push(&unknown).unwrap_err();
        assert_eq!(error, MeasureError::NoSingleTime { frame: 1, found: "unknown" });
    }
}
