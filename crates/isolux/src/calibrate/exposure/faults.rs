//! What went wrong while an exposure sweep was recorded.

use super::mean_curve::{Cleaned, MeanCurve};
use super::proportion::{deviation, ln_rates};
use crate::calibrate::drift::{Drift, DriftWatch, is_proven};
use crate::calibrate::lag::{Level, lag};
use crate::calibrate::severity::DOUBTFUL_SHARE;
use crate::calibrate::sweep_fault::SweepFault;

/// Finds the faults of a sweep. `noise_dn` is the noise of a pixel at the shortest time, where it is known.
pub(super) fn faults(
    recording: &str,
    curve: &mut MeanCurve,
    watch: &DriftWatch,
    noise_dn: Option<f64>,
) -> Vec<SweepFault> {
    let recording = || recording.to_owned();
    if let Some(frames) = lag(&levels(curve)) {
        // Nothing else can be told from frames whose times are wrong.
        return vec![SweepFault::TimesLag { recording: recording(), frames }];
    }
    let Cleaned { stray, moved } = curve.clean();
    let stray = stray.map(|stray| SweepFault::StrayFrames {
        recording: recording(),
        frames: stray.count,
        worst: stray.worst,
        departure: stray.departure,
    });
    let moved = moved.map(|moved| SweepFault::PartsMoved {
        recording: recording(),
        frames: moved.frames,
        share: moved.share,
    });
    let mut found: Vec<SweepFault> = stray.into_iter().chain(moved).collect();
    let rates = noise_dn.map_or_else(Vec::new, |noise_dn| ln_rates(curve.times(), noise_dn));
    found.extend(drifting(&recording(), watch.drift(), rates));
    found
}

/// The drift between equal frames, if amplitudes per time do not contradict it.
fn drifting(recording: &str, drift: Option<Drift>, rates: Vec<(f64, f64)>) -> Option<SweepFault> {
    let recording = || recording.to_owned();
    let drift = drift.filter(|drift| drift.is_significant() && drift.extent().abs() > DOUBTFUL_SHARE);
    let relative = deviation(&rates);
    let rates = [rates];
    let told = drift.map(|drift| (drift.extent(), drift.agreement(&rates)));
    match told {
        Some((extent, Some(agreement))) if is_proven(agreement) => {
            Some(SweepFault::Drift { recording: recording(), relative: extent })
        }
        _ if relative.abs() > DOUBTFUL_SHARE => {
            Some(SweepFault::NotInProportion { recording: recording(), relative })
        }
        Some((relative, None)) => Some(SweepFault::DriftOrSettling { recording: recording(), relative }),
        _ => None,
    }
}

/// The level of each frame, in the order of recording.
fn levels(curve: &MeanCurve) -> Vec<Level> {
    let dead = curve.dead();
    let mut numbered: Vec<(usize, Level)> = curve
        .times()
        .iter()
        .flat_map(|(&bits, frames)| {
            frames.iter().map(move |frame| {
                let ln_level = if frame.count(dead) == 0 { f64::NEG_INFINITY } else { frame.mean(dead).ln() };
                (frame.number, Level { time_us: f64::from_bits(bits), ln_level, place: 0 })
            })
        })
        .collect();
    numbered.sort_by_key(|frame| frame.0);
    numbered.into_iter().map(|frame| frame.1).collect()
}
