//! Measuring a distance sweep: mean amplitude and mean distance in the central window, frame by frame.

use std::collections::BTreeMap;

use super::runs::{Place, Runs};
use super::warning::FitWarning;
use super::window::{Measurement, measure};
use super::{CalibrateError, CalibrateSettings};
use crate::frame::{Frame, IntegrationTime};
use crate::numerics::statistics::upper_median;
use crate::terms::Source;
use crate::terms::cubic::{Decay, DecayPoint};

/// Decays whose median signal-to-noise ratio is lower are left out: their distances are not reliable.
const LEAST_SIGNAL_TO_NOISE: f64 = 10.0;
/// Consecutive frames within this distance of the first belong to one position, or within
/// [`POSITION_STANDARD_ERRORS`] where the distance is noisy.
const POSITION_TOLERANCE_M: f64 = 0.005;
/// Two means of one position differ by more once in 15 000 times.
const POSITION_STANDARD_ERRORS: f64 = 4.0;
/// The window's mean distance may scatter by this many standard errors before the target counts as moving.
const STANDARD_ERRORS: f64 = 8.0;
/// A decay of which fewer frames than this share have a reliable distance is left out as a whole, like the
/// paper's 0.2 ms: what is left of it is the lucky part of noise.
const LEAST_RELIABLE_SHARE: f64 = 1.0 / 3.0;
/// A distance that changes by more than this share across the window is a tilted target.
const TILT_SHARE: f64 = 0.02;

/// A flat target at several distances and integration times, measured frame by frame.
#[derive(Clone, Debug)]
pub struct DistanceSweep {
    recording: String,
    settings: CalibrateSettings,
    runs: Runs,
    frames: usize,
    unusable: usize,
    /// Keyed by the bits of the time, NaN where it is unknown.
    times: BTreeMap<u64, Positions>,
    /// Time of the last position, so that a change of time starts a new one.
    last_time: Option<u64>,
    widest: Option<Widest>,
}

/// What was measured at one integration time.
#[derive(Clone, Debug, Default)]
struct Positions {
    reliable: Vec<Position>,
    /// Frames without a reliable distance.
    unreliable: usize,
}

/// Frames of one place of the target.
#[derive(Clone, Debug)]
struct Position {
    first_frame: usize,
    measurements: Vec<Measurement>,
}

/// The frame with the largest tilt so far.
#[derive(Clone, Copy, Debug)]
struct Widest {
    frame: usize,
    tilt: f64,
    spread_m: f64,
}

/// What a distance sweep says: one decay per integration time.
#[derive(Clone, Debug, PartialEq)]
pub struct ReferenceDecays {
    /// The recording.
    pub source: Source,
    /// Decays in the order of time, over-saturated positions and weak decays left out.
    pub decays: Vec<Decay>,
    /// What was left out, and what is odd about the recording.
    pub warnings: Vec<FitWarning>,
}

impl DistanceSweep {
    /// Starts a sweep; `recording` is the name that errors and the calibration give it.
    #[must_use]
    pub fn new(recording: impl Into<String>, settings: &CalibrateSettings) -> Self {
        Self {
            recording: recording.into(),
            settings: settings.clone(),
            runs: Runs::new(settings.skip_frames),
            frames: 0,
            unusable: 0,
            times: BTreeMap::new(),
            last_time: None,
            widest: None,
        }
    }

    /// Measures the next frame. Its integration time may be unknown, but not a map.
    ///
    /// # Errors
    /// [`CalibrateError`] when the frame has no distance or planes that do not fit.
    pub fn push(&mut self, frame: &Frame) -> Result<(), CalibrateError> {
        let number = self.frames;
        frame.check_shapes().map_err(|source| CalibrateError::Shape { frame: number, source })?;
        let time_us = match frame.integration_time_us {
            IntegrationTime::PerFrame(time_us) => time_us,
            IntegrationTime::Unknown => f64::NAN,
            IntegrationTime::PerPixel(_) => {
                let found = "a map with a time for each pixel";
                return Err(CalibrateError::NoSingleTime { frame: number, found });
            }
        };
        let distances_m = frame.distance_m.as_ref().ok_or(CalibrateError::NoDistance { frame: number })?;
        self.frames += 1;
        if self.runs.push(time_us) == Place::Settling || self.settings.excludes(time_us) {
            return Ok(());
        }
        let Some(measurement) = measure(frame, distances_m.values(), self.settings.window_px) else {
            self.unusable += 1;
            return Ok(());
        };
        if !measurement.is_reliable() {
            self.times.entry(time_us.to_bits()).or_default().unreliable += 1;
            return Ok(());
        }
        let tilt = measurement.tilt();
        if self.widest.is_none_or(|widest| tilt > widest.tilt) {
            self.widest = Some(Widest { frame: number, tilt, spread_m: measurement.spread_m });
        }
        self.add(time_us.to_bits(), number, measurement);
        Ok(())
    }

    fn add(&mut self, time: u64, number: usize, measurement: Measurement) {
        let same_time = self.last_time.replace(time) == Some(time);
        let positions = &mut self.times.entry(time).or_default().reliable;
        match positions.last_mut() {
            Some(last) if same_time && last.holds(&measurement) => last.measurements.push(measurement),
            _ => positions.push(Position { first_frame: number, measurements: vec![measurement] }),
        }
    }

    /// Ends the sweep: one decay per time, each starting where over-saturation ends.
    #[must_use]
    pub fn finish(self) -> ReferenceDecays {
        let recording = &self.recording;
        let mut warnings = Vec::new();
        if self.unusable > 0 {
            let frames = self.unusable;
            warnings.push(FitWarning::SaturationInWindow { recording: recording.clone(), frames });
        }
        let frames = self.times.values().map(|positions| positions.unreliable).sum();
        if frames > 0 {
            warnings.push(FitWarning::UnreliableDistances { recording: recording.clone(), frames });
        }
        if let Some(widest) = self.widest.filter(|widest| widest.tilt > TILT_SHARE) {
            let Widest { frame, spread_m, .. } = widest;
            warnings.push(FitWarning::TargetNotFronto { recording: recording.clone(), frame, spread_m });
        }
        let (mut decays, mut used) = (Vec::new(), 0);
        for (&bits, positions) in &self.times {
            warnings.extend(positions.reliable.iter().filter_map(|p| p.moved(recording)));
            let time_us = Some(f64::from_bits(bits)).filter(|time| !time.is_nan());
            if let Some((decay, frames)) = decay(recording, time_us, positions, &mut warnings) {
                decays.push(decay);
                used += frames;
            }
        }
        let frames_left_out = self.frames - used;
        let source = Source { recording: self.recording, frames_used: used, frames_left_out };
        ReferenceDecays { source, decays, warnings }
    }
}

impl Position {
    fn holds(&self, next: &Measurement) -> bool {
        self.measurements.first().is_some_and(|first| {
            let noise_m = POSITION_STANDARD_ERRORS * first.distance_error_m.hypot(next.distance_error_m);
            (first.distance_m - next.distance_m).abs() <= noise_m.max(POSITION_TOLERANCE_M)
        })
    }

    fn mean(&self, value: impl Fn(&Measurement) -> f64) -> f64 {
        self.measurements.iter().map(value).sum::<f64>() / self.measurements.len() as f64
    }

    /// A range of means that noise does not explain.
    fn moved(&self, recording: &str) -> Option<FitWarning> {
        let distances = || self.measurements.iter().map(|m| m.distance_m);
        let range_m =
            distances().fold(f64::NEG_INFINITY, f64::max) - distances().fold(f64::INFINITY, f64::min);
        let noise_m = self.mean(|m| m.distance_error_m);
        // Half the tolerance that defines a position: no position can range over more than twice of it.
        let moved = range_m > (STANDARD_ERRORS * noise_m).max(0.5 * POSITION_TOLERANCE_M);
        moved.then(|| FitWarning::TargetMoved {
            recording: recording.to_owned(),
            frame: self.first_frame,
            range_m,
        })
    }
}

/// The decay of one integration time and the frames in it; `None` when the signal is too weak.
fn decay(
    recording: &str,
    integration_time_us: Option<f64>,
    positions: &Positions,
    warnings: &mut Vec<FitWarning>,
) -> Option<(Decay, usize)> {
    let reliable: usize = positions.reliable.iter().map(|p| p.measurements.len()).sum();
    let frames = reliable + positions.unreliable;
    if (reliable as f64) < LEAST_RELIABLE_SHARE * frames as f64 {
        let recording = recording.to_owned();
        warnings.push(FitWarning::FewReliable { recording, integration_time_us, reliable, frames });
        return None;
    }
    let mut sorted: Vec<&Position> = positions.reliable.iter().collect();
    sorted.sort_by(|a, b| a.mean(|m| m.distance_m).total_cmp(&b.mean(|m| m.distance_m)));
    let brightness = |p: &&Position| p.mean(|m| m.amplitude_dn);
    let peak =
        (0..sorted.len()).max_by(|&a, &b| brightness(&sorted[a]).total_cmp(&brightness(&sorted[b])))?;
    if peak > 0 {
        let from_m = sorted[peak].mean(|m| m.distance_m);
        let recording = recording.to_owned();
        warnings.push(FitWarning::OverSaturated { recording, integration_time_us, positions: peak, from_m });
    }
    let usable = &sorted[peak..];
    let mut ratios: Vec<f64> = usable.iter().map(|p| p.mean(|m| m.signal_to_noise)).collect();
    let signal_to_noise = upper_median(&mut ratios)?;
    if signal_to_noise < LEAST_SIGNAL_TO_NOISE {
        let recording = recording.to_owned();
        warnings.push(FitWarning::LowSignal { recording, integration_time_us, signal_to_noise });
        return None;
    }
    let point = |p: &&Position| DecayPoint {
        distance_m: p.mean(|m| m.distance_m),
        amplitude_dn: p.mean(|m| m.amplitude_dn),
    };
    let points = usable.iter().map(point).collect();
    let frames = usable.iter().map(|p| p.measurements.len()).sum();
    Some((Decay { integration_time_us, points }, frames))
}

#[cfg(test)]
mod tests {
    use super::*;
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
        assert!(matches!(found.warnings[0], FitWarning::OverSaturated { positions: 1, .. }));
    }

    #[test]
    fn weak_decays_and_saturated_windows_are_left_out_with_a_warning() {
        let found = finish(&[frame(200.0, 1.0, 30.0, 8.0), frame(9000.0, 0.5, 4000.0, 1.0)]);
        assert!(found.decays.is_empty());
        assert_eq!((found.source.frames_used, found.source.frames_left_out), (0, 2));
        assert!(matches!(found.warnings[0], FitWarning::SaturationInWindow { frames: 1, .. }));
        assert!(matches!(found.warnings[1], FitWarning::LowSignal { .. }));
    }

    #[test]
    fn windows_without_a_distance_are_left_out() {
        let mut collapsed = frame(9000.0, 3.0, 40.0, 8.0);
        let scattered = |row: usize, column: usize| 0.5 + ((row * 37 + column * 61) % 64) as f32 / 10.0;
        collapsed.distance_m = Some(Plane::from_fn(collapsed.shape(), scattered));
        let found = finish(&[collapsed, frame(9000.0, 1.0, 900.0, 1.0)]);
        assert_eq!(found.decays[0].points.len(), 1);
        assert!(matches!(found.warnings[0], FitWarning::UnreliableDistances { frames: 1, .. }));
    }

    #[test]
    fn a_tilted_target_is_reported() {
        let mut tilted = frame(1000.0, 1.0, 100.0, 1.0);
        tilted.distance_m = Some(Plane::from_fn(tilted.shape(), |_, column| 1.0 + 0.003 * column as f32));
        let found = finish(&[tilted]);
        assert!(matches!(found.warnings[0], FitWarning::TargetNotFronto { frame: 0, .. }));
    }

    #[test]
    fn a_target_that_creeps_is_reported() {
        let found = finish(&[1.0, 1.002, 1.004].map(|d| frame(1000.0, d, 100.0, 1.0)));
        assert!(matches!(found.warnings[0], FitWarning::TargetMoved { frame: 0, .. }));
    }
}
