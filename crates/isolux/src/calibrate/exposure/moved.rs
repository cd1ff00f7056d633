//! Parts of the image that show something else in some frames, such as a person who walks through a sweep.

use std::collections::BTreeMap;

use super::frame_sums::{FrameSums, Times, kept};
use crate::calibrate::blocks::{Block, SIDE, around};
use crate::numerics::differences::DISTANCE_NOISE_SHARE;
use crate::numerics::statistics::{SIGMA_PER_MAD, median, median_absolute_deviation};

/// Frames of which parts were left out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Moved {
    pub(super) frames: usize,
    /// Largest share of the image that was left out in one of them.
    pub(super) share: f64,
}

/// Cameras shift their distances by a few centimetres when the integration time changes; a larger difference is
/// movement.
const SHIFT_M: f32 = 0.05;
/// Mean distances are compared beyond this many standard errors.
const STANDARD_ERRORS: f32 = 6.0;
/// Distances of compressed pixels drift. They are compared while the mean amplitude per time is above this share of
/// its usual value.
const LINEAR_SHARE: f64 = 0.7;
/// Share by which a block's amplitude departs from its neighbours in time when something else is in it.
const DEPARTURE: f64 = 0.15;
/// ... or by this many standard deviations of its changes from time to time.
const DEVIATIONS: f64 = 8.0;
/// Times on either side with which a block is compared.
const REACH: usize = 6;
/// A frame of which more than this share moved cannot be filled in.
const MOST_SHARE: f64 = 0.6;

/// Marks what moved and fills in what those parts of the image would have shown, by their share of the rest at the
/// nearest times before and after. `None` where nothing moved, or too much.
pub(super) fn fill_in(times: &mut Times) -> Option<Moved> {
    let frames = kept(times);
    let series = Series::new(&frames)?;
    let moved = series.moved();
    let share = |blocks: &Vec<usize>| blocks.len() as f64 / series.used.max(1) as f64;
    let largest = moved.iter().map(share).fold(0.0, f64::max);
    if largest == 0.0 || largest > MOST_SHARE {
        return None;
    }
    let filled: BTreeMap<usize, (Vec<usize>, f64)> = (0..frames.len())
        .filter(|&at| !moved[at].is_empty())
        .map(|at| (frames[at].1.number, (moved[at].clone(), series.whole(at, &moved))))
        .collect();
    for frame in times.values_mut().flatten() {
        if let Some((blocks, sum)) = filled.get(&frame.number) {
            frame.moved.clone_from(blocks);
            frame.sum = *sum;
        }
    }
    Some(Moved { frames: filled.len(), share: largest })
}

/// All frames by increasing time.
struct Series<'a> {
    frames: &'a [(f64, &'a FrameSums)],
    /// Blocks with pixels.
    used: usize,
    /// Up to here, amplitudes hardly fall behind the time, so that distances can be compared.
    linear: usize,
    /// Up to here, the image becomes brighter.
    rising: usize,
}

impl<'a> Series<'a> {
    fn new(frames: &'a [(f64, &'a FrameSums)]) -> Option<Self> {
        if frames.len() < 3 {
            return None;
        }
        let seen = |block: &usize| frames.iter().any(|(_, frame)| frame.blocks[*block].count > 0);
        let used = (0..SIDE * SIDE).filter(seen).count();
        let level = |at: usize| frames[at].1.sum;
        let peak = (0..frames.len()).max_by(|&a, &b| level(a).total_cmp(&level(b)))?;
        let mut rates: Vec<f64> = (0..=peak)
            .filter(|&at| level(at) > 0.1 * level(peak))
            .map(|at| level(at) / frames[at].0)
            .collect();
        let usual = median(&mut rates)?;
        let linear = (0..=peak).rev().find(|&at| level(at) / frames[at].0 > LINEAR_SHARE * usual)? + 1;
        Some(Self { frames, used, linear, rising: peak + 1 })
    }

    fn block(&self, at: usize, block: usize) -> &Block {
        &self.frames[at].1.blocks[block]
    }

    /// For every frame, the blocks that show something else, and those beside them, which may do so in part.
    fn moved(&self) -> Vec<Vec<usize>> {
        let common = self.common();
        let mut marks = vec![[false; SIDE * SIDE]; self.frames.len()];
        for block in 0..SIDE * SIDE {
            let found = self.elsewhere(block).chain(self.unlike(block, &common));
            for at in found {
                around(block).for_each(|near| marks[at][near] = true);
            }
        }
        let listed = |(at, marks): (usize, &[bool; SIDE * SIDE])| -> Vec<usize> {
            (0..SIDE * SIDE).filter(|&block| marks[block] && self.block(at, block).count > 0).collect()
        };
        marks.iter().enumerate().map(listed).collect()
    }

    /// Frames in which a block is at another distance than usual.
    fn elsewhere(&self, block: usize) -> impl Iterator<Item = usize> {
        let reliable = |at: &usize| {
            let block = self.block(*at, block);
            block.distance_sd_m <= DISTANCE_NOISE_SHARE as f32 * block.distance_m
        };
        let known: Vec<usize> = (0..self.linear).filter(reliable).collect();
        let mut distances: Vec<f64> =
            known.iter().map(|&at| f64::from(self.block(at, block).distance_m)).collect();
        let usual = median(&mut distances).unwrap_or(f64::NAN) as f32;
        let away = |at: &usize| {
            let block = self.block(*at, block);
            (block.distance_m - usual).abs() > SHIFT_M + STANDARD_ERRORS * block.distance_error_m()
        };
        known.into_iter().filter(away).collect::<Vec<_>>().into_iter()
    }

    /// ln of the amplitude of each frame that most blocks share.
    fn common(&self) -> Vec<f64> {
        let logs = |at: usize| (0..SIDE * SIDE).map(move |block| self.ln_amplitude(at, block));
        let first: Vec<f64> = logs(self.rising / 2).collect();
        let common = |at: usize| {
            let ratios = logs(at).zip(&first).map(|(now, first)| now - first);
            median(&mut ratios.filter(|ratio| ratio.is_finite()).collect::<Vec<_>>()).unwrap_or(f64::NAN)
        };
        (0..self.rising).map(common).collect()
    }

    fn ln_amplitude(&self, at: usize, block: usize) -> f64 {
        self.block(at, block).mean_dn().ln()
    }

    /// Frames in which the amplitude of a block departs from its course over the neighbouring frames.
    fn unlike(&self, block: usize, common: &[f64]) -> impl Iterator<Item = usize> {
        let course: Vec<f64> =
            common.iter().enumerate().map(|(at, common)| self.ln_amplitude(at, block) - common).collect();
        let changes = course.windows(2).map(|pair| pair[1] - pair[0]).filter(|change| change.is_finite());
        let sigma = SIGMA_PER_MAD
            * median_absolute_deviation(&mut changes.collect::<Vec<_>>()).unwrap_or(f64::INFINITY);
        let amplitude = |at: usize| self.ln_amplitude(at, block).exp();
        let all = (0..course.len()).map(amplitude).filter(|value| value.is_finite());
        let usual = median(&mut all.collect::<Vec<_>>()).unwrap_or(f64::INFINITY);
        let departs = |at: &usize| {
            // The relative noise grows as the amplitude falls, at most in proportion.
            let sigma = sigma * (usual / amplitude(*at)).max(1.0);
            let reach = REACH.min(*at).min(course.len() - 1 - at);
            let near = course[at - reach..=at + reach].iter().copied().filter(|value| value.is_finite());
            let usual = median(&mut near.collect::<Vec<_>>()).unwrap_or(f64::NAN);
            (course[*at] - usual).abs() > DEPARTURE.max(DEVIATIONS * sigma)
        };
        (0..course.len()).filter(departs).collect::<Vec<_>>().into_iter()
    }

    /// The sum of a frame if nothing had moved.
    fn whole(&self, at: usize, moved: &[Vec<usize>]) -> f64 {
        let rest: f64 = (0..SIDE * SIDE)
            .filter(|block| !moved[at].contains(block))
            .map(|block| f64::from(self.block(at, block).sum_dn))
            .sum();
        rest + moved[at].iter().map(|&block| self.expected(at, block, moved)).sum::<f64>()
    }

    /// The sum of a block if nothing had moved, in proportion to blocks that did not move.
    fn expected(&self, at: usize, block: usize, moved: &[Vec<usize>]) -> f64 {
        let from = |other: usize| {
            let still =
                (0..SIDE * SIDE).filter(|still| !moved[at].contains(still) && !moved[other].contains(still));
            let (here, there) = still.fold((0.0, 0.0), |(here, there), still| {
                let sum = |at: usize| f64::from(self.block(at, still).sum_dn);
                (here + sum(at), there + sum(other))
            });
            let ln_sum = (f64::from(self.block(other, block).sum_dn) * here / there).ln();
            ln_sum.is_finite().then(|| (self.frames[other].0.ln(), ln_sum))
        };
        let shows = |other: &usize| !moved[*other].contains(&block);
        let before = (0..at).rev().find(shows).and_then(from);
        let after = (at + 1..self.frames.len()).find(shows).and_then(from);
        let ln_time = self.frames[at].0.ln();
        match (before, after) {
            (Some((x0, y0)), Some((x1, y1))) if x1 > x0 => y0 + (ln_time - x0) * (y1 - y0) / (x1 - x0),
            (Some((_, y)), _) | (None, Some((_, y))) => y,
            (None, None) => f64::NEG_INFINITY,
        }
        .exp()
    }
}
