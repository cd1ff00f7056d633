//! Frames whose amplitude is another one than that of their repeats: a black frame, a flash.

use super::frame_sums::{FrameSums, Times};
use crate::calibrate::smooth_curve::{departure, expected};
use crate::calibrate::stray::{DEVIATIONS, LEAST_DEPARTURE, Stray, few_off, is_disputed, wrong_of_two};
use crate::numerics::statistics::{SIGMA_PER_MAD, median, median_absolute_deviation};

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

    fn is_disputed(&self, tolerance: f64) -> bool {
        is_disputed(&self.ln_levels, tolerance)
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
        let off = few_off(&group.ln_levels, group.median(), tolerance);
        found.extend(off.into_iter().map(|(index, departure)| (group.bits, index, departure)));
    }
    for group in repeats.iter().filter(|group| group.is_disputed(tolerance)) {
        let Some(level) = expected(&curve, group.ln_time) else { continue };
        let (wrong, departure) = wrong_of_two(&group.ln_levels, level);
        found.push((group.bits, wrong, departure));
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
    let marked = found.iter().filter_map(|&(bits, index, departure)| {
        let frame = times.get_mut(&bits)?.get_mut(index)?;
        frame.stray = true;
        Some((frame.number, departure))
    });
    Stray::of(marked)
}
