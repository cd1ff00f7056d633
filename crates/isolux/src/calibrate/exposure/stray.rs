//! Frames whose amplitude is another one than that of their repeats: a black frame, a flash.

use super::frame_sums::{FrameSums, Times};
use crate::calibrate::smooth_curve::{departure, expected};
use crate::numerics::statistics::{SIGMA_PER_MAD, median, median_absolute_deviation};

/// Frames that were left out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Stray {
    pub(super) frames: usize,
    /// The frame that departs most.
    pub(super) worst: usize,
    /// By how much, relative.
    pub(super) departure: f64,
}

/// A frame may differ from its repeats by this share: cameras settle by up to 3 % after a change of the time, and half
/// of it is all that one of two frames adds to an error.
const LEAST_DEPARTURE: f64 = 0.05;
/// ... or by this many standard deviations of all repeats.
const DEVIATIONS: f64 = 8.0;
/// A time with one frame only may depart from the curve of the others by this share: the curve bends.
const LEAST_BEND: f64 = 0.2;
/// When more than this share of the frames departs, it is no exception, and none is left out.
const MANY: f64 = 0.25;
/// Level of a black frame below the brightest, in ln.
const BLACK: f64 = -14.0;

/// A frame, by the bits of its time and its place among the frames of that time, and by how much it departs, in ln.
type Departure = (u64, usize, f64);

/// One integration time.
struct Repeats {
    ln_time: f64,
    bits: u64,
    ln_levels: Vec<f64>,
}

impl Repeats {
    fn median(&self) -> f64 {
        median(&mut self.ln_levels.clone()).unwrap_or(BLACK)
    }

    /// Two frames that differ: only the other times tell which is right.
    fn is_disputed(&self, tolerance: f64) -> bool {
        matches!(self.ln_levels[..], [a, b] if (a - b).abs() > tolerance)
    }

    /// Of three frames or more, those few that differ from the others.
    fn few_off(&self, tolerance: f64) -> impl Iterator<Item = Departure> {
        let median = self.median();
        let departures =
            (0..self.ln_levels.len()).map(|index| (self.bits, index, self.ln_levels[index] - median));
        let off: Vec<Departure> = departures.filter(|found| found.2.abs() > tolerance).collect();
        let few = 2 * off.len() < self.ln_levels.len();
        off.into_iter().filter(move |_| few)
    }
}

/// Marks stray frames. `dead` pixels are 0 in every frame.
pub(super) fn leave_out(times: &mut Times, dead: usize) -> Option<Stray> {
    let repeats = all_repeats(times, dead);
    let mut departures: Vec<f64> = repeats
        .iter()
        .filter(|group| group.ln_levels.len() > 1)
        .flat_map(|group| group.ln_levels.iter().map(|level| level - group.median()))
        .collect();
    let sigma = SIGMA_PER_MAD * median_absolute_deviation(&mut departures).unwrap_or(0.0);
    let tolerance = LEAST_DEPARTURE.max(DEVIATIONS * sigma);
    let mut found = Vec::new();
    let mut curve = Vec::new();
    for group in repeats.iter().filter(|group| !group.is_disputed(tolerance)) {
        curve.push((group.ln_time, group.median()));
        found.extend(group.few_off(tolerance));
    }
    for group in repeats.iter().filter(|group| group.is_disputed(tolerance)) {
        let [a, b] = [group.ln_levels[0], group.ln_levels[1]];
        let Some(level) = expected(&curve, group.ln_time) else { continue };
        let wrong = usize::from((a - level).abs() < (b - level).abs());
        found.push((group.bits, wrong, group.ln_levels[wrong] - group.ln_levels[1 - wrong]));
    }
    found.extend(single(&repeats, &curve));
    let frames = times.values().map(Vec::len).sum::<usize>();
    if found.is_empty() || found.len() as f64 > MANY * frames as f64 {
        return None;
    }
    mark(times, &found)
}

fn all_repeats(times: &Times, dead: usize) -> Vec<Repeats> {
    let level = |frame: &FrameSums| if frame.count(dead) == 0 { 0.0 } else { frame.mean(dead) };
    let brightest = times.values().flatten().map(level).fold(0.0, f64::max);
    let ln_level = |frame: &FrameSums| (level(frame) / brightest).ln().max(BLACK);
    let repeats = times.iter().map(|(&bits, frames)| Repeats {
        ln_time: f64::from_bits(bits).ln(),
        bits,
        ln_levels: frames.iter().map(ln_level).collect(),
    });
    // Without a value in any frame, there is nothing to compare.
    repeats.filter(|group| group.ln_levels.iter().any(|level| *level > BLACK)).collect()
}

/// Times of one frame that departs from the curve, up to its peak, where the table ends.
fn single<'a>(repeats: &'a [Repeats], curve: &'a [(f64, f64)]) -> impl Iterator<Item = Departure> + 'a {
    let peak = (0..curve.len()).max_by(|&a, &b| curve[a].1.total_cmp(&curve[b].1)).unwrap_or(0);
    let departs = move |group: &Repeats| {
        let at = curve.iter().position(|point| point.0 == group.ln_time).filter(|at| *at < peak)?;
        let departure = departure(curve, at)?;
        let bend = if at == 0 { 2f64.ln() } else { LEAST_BEND };
        (departure.abs() > bend).then_some((group.bits, 0, departure))
    };
    repeats.iter().filter(|group| group.ln_levels.len() == 1).filter_map(departs)
}

fn mark(times: &mut Times, found: &[Departure]) -> Option<Stray> {
    let mut worst: Option<(usize, f64)> = None;
    for &(bits, index, departure) in found {
        let Some(frame) = times.get_mut(&bits).and_then(|frames| frames.get_mut(index)) else { continue };
        frame.stray = true;
        if worst.is_none_or(|worst| departure.abs() > worst.1.abs()) {
            worst = Some((frame.number, departure));
        }
    }
    worst.map(|(worst, departure)| Stray { frames: found.len(), worst, departure: departure.exp_m1() })
}
