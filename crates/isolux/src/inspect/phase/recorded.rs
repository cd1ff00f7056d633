//! Do the phases agree with recorded distances?

use std::f64::consts::{FRAC_PI_2, FRAC_PI_8, TAU};

use super::sample::Pixel;
use super::turn::{Pairs, Turn};
use crate::frame::phase;
use crate::numerics::statistics::median;

/// Pixels below which nothing is told.
const FEWEST_PIXELS: usize = 100;
/// Length of the mean of unit vectors in the direction of the differences: 1 where all agree.
const AGREEING: f64 = 0.9;
/// The other direction scatters so many times as much, or the distances do not vary enough to tell.
const CLEARLY: f64 = 4.0;
const LEAST_SCATTER: f64 = 0.02;

/// The way to read the phases that gives the recorded distances.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Agreement {
    pub(super) turn: Turn,
    /// Typical difference of the distances as the phases are read, m.
    pub(super) stated_m: f64,
    /// The same with `turn`.
    pub(super) found_m: f64,
}

/// The way that gives the recorded distances, where they tell it.
pub(super) fn agreement(pixels: &[Pixel], pairs: Pairs, frequency_hz: f64) -> Option<Agreement> {
    let phases: Vec<(f64, f64)> = pixels
        .iter()
        .filter(|pixel| pixel.recorded_m > 0.0 && pixel.recorded_m.is_finite())
        .filter_map(|pixel| {
            let [cosine, sine] = pairs.differences(pixel.bins);
            let found = cosine != 0.0 || sine != 0.0;
            found.then(|| (sine.atan2(cosine), phase::of_distance(frequency_hz, pixel.recorded_m)))
        })
        .collect();
    if phases.len() < FEWEST_PIXELS {
        return None;
    }
    let directions = [false, true].map(|reversed| (mean_difference(&phases, reversed), reversed));
    let [first, second] = directions;
    let (best, other) = if first.0.0 >= second.0.0 { (first, second) } else { (second, first) };
    let ((length, angle), reversed) = best;
    let clear = 1.0 - other.0.0 > CLEARLY * (1.0 - length) + LEAST_SCATTER;
    if length < AGREEING || !clear {
        return None;
    }
    // A camera adds some delay of its own, and none of a quarter of a period.
    let quarters = (-angle / FRAC_PI_2).round();
    let delayed = (angle + quarters * FRAC_PI_2).abs() > FRAC_PI_8;
    let quarters = if delayed { 0 } else { quarters.rem_euclid(4.0) as usize };
    let turn = Turn { pairs, reversed, quarters };
    let typical_m = |turn: Turn| {
        let difference = |&(read, recorded): &(f64, f64)| wrapped(turn.of(read) - recorded).abs();
        let typical = median(&mut phases.iter().map(difference).collect::<Vec<_>>())?;
        Some(typical * phase::metres_per_radian(frequency_hz))
    };
    let stated = Turn { pairs, ..Turn::STATED };
    Some(Agreement { turn, stated_m: typical_m(stated)?, found_m: typical_m(turn)? })
}

/// Length and direction of the mean unit vector of read phase minus recorded phase.
fn mean_difference(phases: &[(f64, f64)], reversed: bool) -> (f64, f64) {
    let sign = if reversed { -1.0 } else { 1.0 };
    let (mut cosine, mut sine) = (0.0, 0.0);
    for (read, recorded) in phases {
        let angle = sign * read - recorded;
        cosine += angle.cos();
        sine += angle.sin();
    }
    let count = phases.len() as f64;
    (cosine.hypot(sine) / count, sine.atan2(cosine))
}

/// An angle in −π..π.
fn wrapped(angle: f64) -> f64 {
    (angle + TAU / 2.0).rem_euclid(TAU) - TAU / 2.0
}
