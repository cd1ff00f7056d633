//! What went wrong while a distance sweep was recorded.

use std::collections::BTreeMap;

use super::background::Background;
use super::decay::{Position, Positions};
use super::step::{Point, step};
use super::wrap::wrapped;
use crate::calibrate::CalibrateSettings;
use crate::calibrate::drift::{DriftWatch, is_proven};
use crate::calibrate::lag::{Level, lag};
use crate::calibrate::severity::DOUBTFUL_SHARE;
use crate::calibrate::stray::Stray;
use crate::calibrate::sweep_fault::SweepFault;
use crate::frame::phase::SPEED_OF_LIGHT_M_PER_S;

/// What is noted of a sweep while it is measured.
#[derive(Clone, Debug, Default)]
pub(super) struct Watch {
    pub(super) levels: Vec<Level>,
    pub(super) drift: DriftWatch,
    pub(super) background: Background,
}

/// Near saturation, no law over distance is smooth. Below this share of the largest amplitude, a soft well takes 3 % or
/// less.
const LOW_SHARE: f64 = 0.4;
/// A position is compressed where its amplitude per time is below this share of that at another time.
const LINEAR_SHARE: f64 = 0.95;
/// Distances of one position differ by less than this share from time to time.
const SAME_POSITION: f64 = 0.01;

/// Finds the faults of a sweep, and leaves out what contradicts the rest. `times` are keyed by their bits.
pub(super) fn faults(
    recording: &str,
    settings: &CalibrateSettings,
    watch: &Watch,
    times: &mut BTreeMap<u64, Positions>,
) -> Vec<SweepFault> {
    let recording = || recording.to_owned();
    if let Some(frames) = lag(&watch.levels) {
        return vec![SweepFault::TimesLag { recording: recording(), frames }];
    }
    // At short times, near positions are the least saturated.
    if let Some(found) = times.values().find_map(|positions| wrapped(&positions.reliable)) {
        let range = |frequency_hz: f64| SPEED_OF_LIGHT_M_PER_S / (2.0 * frequency_hz);
        let range_m = settings.modulation_frequency_hz.map(range);
        let (frame, distance_m) = (found.frame, found.distance_m);
        return vec![SweepFault::Wrapped { recording: recording(), frame, distance_m, range_m }];
    }
    let mut found = Vec::new();
    let all = |found: Vec<Stray>| found.into_iter().reduce(Stray::and);
    let stray = all(times.values_mut().filter_map(Positions::leave_out_frames).collect());
    found.extend(stray.map(|Stray { count, worst, departure }| SweepFault::StrayFrames {
        recording: recording(),
        frames: count,
        worst,
        departure,
    }));
    if let Some(step) = step(&points(times)) {
        let relative = step.ln_factor.exp_m1();
        found.push(SweepFault::TargetChanged { recording: recording(), frame: step.frame, relative });
        return found;
    }
    let of = times.values().map(|positions| positions.reliable.len()).sum();
    let stray = all(times.values_mut().filter_map(Positions::leave_out_positions).collect());
    found.extend(stray.map(|Stray { count, worst, departure }| SweepFault::StrayPositions {
        recording: recording(),
        positions: count,
        of,
        worst,
        departure,
    }));
    found.extend(drifting(&recording(), watch));
    found
}

/// The drift between equal frames, if the background does not contradict it.
fn drifting(recording: &str, watch: &Watch) -> Option<SweepFault> {
    let recording = recording.to_owned();
    let drift = watch.drift.drift()?;
    let relative = drift.extent();
    if !drift.is_significant() || relative.abs() < DOUBTFUL_SHARE {
        return None;
    }
    match drift.agreement(&watch.background.witnesses()) {
        Some(agreement) if is_proven(agreement) => Some(SweepFault::Drift { recording, relative }),
        // The background stays as it is: the camera settles, after each change alike.
        Some(agreement) if agreement < 1.0 => None,
        _ => Some(SweepFault::DriftOrSettling { recording, relative }),
    }
}

/// The positions that are not compressed.
fn points(times: &BTreeMap<u64, Positions>) -> Vec<Point> {
    let positions = || {
        times.iter().enumerate().flat_map(|(time, (&bits, positions))| {
            positions.reliable.iter().map(move |position| (time, f64::from_bits(bits), position))
        })
    };
    let amplitude = |position: &Position| position.mean(|m| m.amplitude_dn);
    let rate = |time_us: f64, position: &Position| amplitude(position) / time_us;
    let largest_dn = positions().map(|(_, _, position)| amplitude(position)).fold(0.0, f64::max);
    let is_linear = |&(_, time_us, position): &(usize, f64, &Position)| {
        let (ln_distance, _) = position.place();
        let same = positions().filter(|(_, _, other)| (other.place().0 - ln_distance).abs() < SAME_POSITION);
        let best = same.map(|(_, time_us, other)| rate(time_us, other)).fold(0.0, f64::max);
        // A time that is not known is the only one.
        amplitude(position) < LOW_SHARE * largest_dn
            && (time_us.is_nan() || rate(time_us, position) > LINEAR_SHARE * best)
    };
    let point = |(time, _, position): (usize, f64, &Position)| {
        let ((ln_distance, ln_level), frame) = (position.place(), position.frames.first().copied());
        Point { time, frame: frame.unwrap_or(0), ln_distance, ln_level }
    };
    positions().filter(is_linear).map(point).collect()
}
