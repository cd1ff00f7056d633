//! Measures a distance sweep: mean amplitude (DN) and mean distance (m) in the central window, frame by frame.

use std::collections::BTreeMap;

use super::DistanceWarning;
use super::centre::{Measurement, measure};
use super::decay::Positions;
use super::faults::{Watch, faults};
use super::repeats::Repeats;
use crate::calibrate::lag::Level;
use crate::calibrate::sweep_frames::{SweepFrames, single_or_unknown_time};
use crate::calibrate::{CalibrateSettings, MeasureError};
use crate::frame::Frame;
use crate::terms::Source;
use crate::terms::cubic::Decay;
use crate::terms::response::TargetSample;

/// The target is tilted if the distance changes by more than this share across the window.
const TILT_SHARE: f64 = 0.02;

/// A flat target at several distances and integration times, measured frame by frame.
#[derive(Clone, Debug)]
pub struct DistanceSweep {
    frames: SweepFrames,
    unusable: usize,
    /// Keyed by the bits of the time, NaN where it is unknown.
    times: BTreeMap<u64, Positions>,
    /// Time of the last position, so that a change of time starts a new one.
    last_time: Option<u64>,
    repeats: Repeats,
    widest: Option<Widest>,
    watch: Watch,
    last: Option<Seen>,
}

/// What is remembered of the last frame.
#[derive(Clone, Copy, Debug)]
struct Seen {
    number: usize,
    time: u64,
    /// Distance in the window, m; NaN where it could not be measured.
    distance_m: f64,
    /// Number of the place that the target is in.
    place: usize,
}

/// The frame with the largest tilt so far.
#[derive(Clone, Copy, Debug)]
struct Widest {
    frame: usize,
    tilt: f64,
    spread_m: f64,
}

/// The result of a distance sweep: one decay per integration time.
#[derive(Clone, Debug, PartialEq)]
pub struct ReferenceDecays {
    /// The recording.
    pub source: Source,
    /// Decays by increasing time, without over-saturated positions and weak decays.
    pub decays: Vec<Decay>,
    /// The positions at known times, for the response by amplitude and distance.
    pub samples: Vec<TargetSample>,
    /// What was left out, and what the recording lacks.
    pub warnings: Vec<DistanceWarning>,
}

impl DistanceSweep {
    /// Starts a sweep; `recording` is its name in errors and in the calibration.
    #[must_use]
    pub fn new(recording: impl Into<String>, settings: &CalibrateSettings) -> Self {
        Self {
            frames: SweepFrames::new(recording, settings),
            unusable: 0,
            times: BTreeMap::new(),
            last_time: None,
            repeats: Repeats::default(),
            widest: None,
            watch: Watch::default(),
            last: None,
        }
    }

    /// Measures the next frame. Its integration time may be unknown, but not a map.
    ///
    /// # Errors
    /// [`MeasureError`] when the frame has no distance, a map of times, or planes of different shapes.
    pub fn push(&mut self, frame: &Frame) -> Result<(), MeasureError> {
        let number = self.frames.next(frame)?;
        let time_us = single_or_unknown_time(&frame.integration_time_us)
            .map_err(|found| MeasureError::NoSingleTime { frame: number, found })?;
        let distances_m = frame.distance_m.as_ref().ok_or(MeasureError::NoDistance { frame: number })?;
        if self.frames.place(time_us).is_none() {
            return Ok(());
        }
        let measured = measure(frame, distances_m.values(), self.frames.settings.window_px);
        self.note(number, time_us, frame, measured.as_ref());
        match measured {
            Some(measurement) => {
                self.add(time_us.to_bits(), number, measurement, (frame, distances_m.values()))
            }
            None => self.unusable += 1,
        }
        Ok(())
    }

    /// Notes what tells the faults of the recording.
    fn note(&mut self, number: usize, time_us: f64, frame: &Frame, measured: Option<&Measurement>) {
        /// From one place to the next, the target moves by this share at least.
        const NEXT_PLACE: f64 = 0.02;
        let (time, found) = (time_us.to_bits(), measured.filter(|found| found.is_reliable()));
        let distance_m = found.map_or(f64::NAN, |found| found.distance_m);
        let (mut place, mut repeats) = (0, false);
        if let Some(last) = self.last {
            let moved = (distance_m - last.distance_m).abs() > NEXT_PLACE * last.distance_m;
            place = last.place + usize::from(moved);
            repeats = last.number + 1 == number && last.time == time && !moved && !distance_m.is_nan();
        }
        self.last = Some(Seen { number, time, distance_m, place });
        let ln_level = found.map_or(f64::NAN, |found| found.amplitude_dn.ln());
        self.watch.levels.push(Level { time_us, ln_level, place });
        self.watch.drift.push(number, frame, repeats);
        self.watch.background.push(number, time, frame);
    }

    fn add(&mut self, time: u64, number: usize, measurement: Measurement, frame: (&Frame, &[f32])) {
        let positions = self.times.entry(time).or_default();
        if !measurement.is_reliable() {
            positions.unreliable += 1;
            return;
        }
        let tilt = measurement.tilt();
        if self.widest.is_none_or(|widest| tilt > widest.tilt) {
            self.widest = Some(Widest { frame: number, tilt, spread_m: measurement.spread_m });
        }
        let follows = self.last_time.replace(time) == Some(time);
        let repeats = positions.add(number, measurement, follows);
        let (frame, distances_m) = frame;
        if let Some(noise) = self.repeats.push(frame, distances_m, &measurement, repeats) {
            positions.add_noise(noise);
        }
    }

    /// Ends the sweep: one decay per time, each starting where over-saturation ends.
    #[must_use]
    pub fn finish(mut self) -> ReferenceDecays {
        let recording = &self.frames.recording;
        let found = faults(recording, &self.frames.settings, &self.watch, &mut self.times);
        let mut warnings: Vec<DistanceWarning> = found.into_iter().map(DistanceWarning::Fault).collect();
        if self.unusable > 0 {
            let frames = self.unusable;
            warnings.push(DistanceWarning::SaturationInWindow { recording: recording.clone(), frames });
        }
        let frames = self.times.values().map(|positions| positions.unreliable).sum();
        if frames > 0 {
            warnings.push(DistanceWarning::UnreliableDistances { recording: recording.clone(), frames });
        }
        if let Some(widest) = self.widest.filter(|widest| widest.tilt > TILT_SHARE) {
            let Widest { frame, spread_m, .. } = widest;
            warnings.push(DistanceWarning::TargetNotFronto { recording: recording.clone(), frame, spread_m });
        }
        // The bits of NaN: one decay at an unknown time, which may have been another one at each distance.
        let unknown = |(bits, positions): (&u64, &Positions)| {
            f64::from_bits(*bits).is_nan() && positions.reliable.len() > 1
        };
        if self.times.iter().any(unknown) {
            warnings.push(DistanceWarning::TimesUnknown { recording: recording.clone() });
        }
        let (mut decays, mut samples, mut used) = (Vec::new(), Vec::new(), 0);
        for (&bits, positions) in &self.times {
            warnings.extend(positions.moved(recording));
            let time_us = Some(f64::from_bits(bits)).filter(|time| !time.is_nan());
            samples.extend(time_us.map(|time_us| positions.samples(time_us)).unwrap_or_default());
            if let Some((decay, frames)) = positions.decay(recording, time_us, &mut warnings) {
                decays.push(decay);
                used += frames;
            }
        }
        ReferenceDecays { source: self.frames.source(used), decays, samples, warnings }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::IntegrationTime;
    use crate::frame::{Plane, Shape};

    /// A board at `distance_m` with one row brighter by `texture_dn`, the only "noise" there is.
    fn frame(time_us: f64, distance_m: f32, amplitude_dn: f32, noise_dn: f32) -> Frame {
        let shape = Shape::new(20, 20);
        let mut frame = Frame::new(shape);
        let noise =
            |row: usize, column: usize| if (row * 7 + column * 3) % 5 < 2 { noise_dn } else { -noise_dn };
        frame.amplitude = Plane::from_fn(shape, |row, column| amplitude_dn + noise(row, column));
        frame.distance_m = Some(Plane::filled(shape, distance_m));
        frame.integration_time_us = IntegrationTime::PerFrame(time_us);
        frame.flag_amplitude(Some(4000.0));
        frame
    }

    fn finish(frames: &[Frame]) -> ReferenceDecays {
        let mut sweep = DistanceSweep::new("board", &CalibrateSettings::default());
        frames.iter().try_for_each(|frame| sweep.push(frame)).unwrap();
        sweep.finish()
    }

    #[test]
    fn frames_of_one_position_are_averaged_and_times_kept_apart() {
        let frames = [(1000.0, 1.0), (1000.0, 1.001), (2000.0, 1.0), (1000.0, 2.0)]
            .map(|(t, d)| frame(t, d, 500.0 / d, 1.0));
        let found = finish(&frames);
        let sizes: Vec<_> = found.decays.iter().map(|d| (d.integration_time_us, d.points.len())).collect();
        assert_eq!(sizes, [(Some(1000.0), 2), (Some(2000.0), 1)]);
        assert!((found.decays[0].points[0].distance_m - 1.0005).abs() < 1e-6);
    }

    #[test]
    fn each_decay_starts_where_over_saturation_ends() {
        let found =
            finish(&[(0.5, 900.0), (0.7, 2000.0), (1.0, 1500.0)].map(|(d, a)| frame(1000.0, d, a, 1.0)));
        let distances: Vec<f64> =
            found.decays[0].points.iter().map(|p| (p.distance_m * 10.0).round()).collect();
        assert_eq!(distances, [7.0, 10.0]);
        assert!(matches!(found.warnings[0], DistanceWarning::OverSaturated { positions: 1, .. }));
    }

    #[test]
    fn weak_decays_and_saturated_windows_are_left_out_with_a_warning() {
        let found = finish(&[frame(200.0, 1.0, 30.0, 8.0), frame(9000.0, 0.5, 4000.0, 1.0)]);
        assert!(found.decays.is_empty());
        assert_eq!((found.source.frames_used, found.source.frames_left_out), (0, 2));
        assert!(matches!(found.warnings[0], DistanceWarning::SaturationInWindow { frames: 1, .. }));
        assert!(matches!(found.warnings[1], DistanceWarning::LowSignal { .. }));
    }

    #[test]
    fn windows_without_a_distance_are_left_out() {
        let mut collapsed = frame(9000.0, 3.0, 40.0, 8.0);
        let scattered = |row: usize, column: usize| 0.5 + ((row * 37 + column * 61) % 64) as f32 / 10.0;
        collapsed.distance_m = Some(Plane::from_fn(collapsed.shape(), scattered));
        let found = finish(&[collapsed, frame(9000.0, 1.0, 900.0, 1.0)]);
        assert_eq!(found.decays[0].points.len(), 1);
        assert!(matches!(found.warnings[0], DistanceWarning::UnreliableDistances { frames: 1, .. }));
    }

    #[test]
    fn a_tilted_target_is_reported() {
        let mut tilted = frame(1000.0, 1.0, 100.0, 1.0);
        tilted.distance_m = Some(Plane::from_fn(tilted.shape(), |_, column| 1.0 + 0.003 * column as f32));
        let found = finish(&[tilted]);
        assert!(matches!(found.warnings[0], DistanceWarning::TargetNotFronto { frame: 0, .. }));
    }

    #[test]
    fn a_target_that_creeps_is_reported() {
        let found = finish(&[1.0, 1.002, 1.004].map(|d| frame(1000.0, d, 100.0, 1.0)));
        assert!(matches!(found.warnings[0], DistanceWarning::TargetMoved { frame: 0, .. }));
    }
}
