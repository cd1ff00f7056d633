//! Parts of the image that stay where they are while the target is moved: they witness the gain.

use std::collections::BTreeMap;

use crate::calibrate::blocks::{Block, blocks};
use crate::frame::Frame;
use crate::numerics::statistics::median;

/// A block stays where it is when its mean distance changes by less than this ...
const SHIFT_M: f32 = 0.005;
/// ... and this many standard errors.
const STANDARD_ERRORS: f32 = 4.0;
/// A block whose distances scatter by more than this share shows an edge, or noise.
const SCATTER_SHARE: f32 = 0.25;
/// The scatter of a block that stays the same changes by less than this factor: that of one with 170 pixels is known to
/// 5 %. A block that the target leaves in part scatters less.
const SCATTER_CHANGE: f32 = 1.2;
/// Blocks that two frames must share to be compared.
const LEAST_BLOCKS: usize = 6;

/// Follows what stands still, for each integration time apart.
#[derive(Clone, Debug, Default)]
pub(super) struct Background {
    /// The last frame of each time.
    last: BTreeMap<u64, Box<[Block]>>,
    /// ln of the gain at frames; a list for each time and each stretch without a gap.
    courses: BTreeMap<u64, Vec<Vec<(f64, f64)>>>,
}

impl Background {
    /// Takes the frame of this number and time.
    pub(super) fn push(&mut self, number: usize, time: u64, frame: &Frame) {
        let now = blocks(frame);
        let change = self.last.get(&time).and_then(|before| change(before, &now));
        self.last.insert(time, now);
        let courses = self.courses.entry(time).or_default();
        let number = number as f64;
        match (change, courses.last_mut().filter(|course| !course.is_empty())) {
            (Some(change), Some(course)) => {
                let level = course.last().map_or(0.0, |point| point.1);
                course.push((number, level + change));
            }
            _ => courses.push(vec![(number, 0.0)]),
        }
    }

    /// ln of the gain at frames, each list up to a constant.
    pub(super) fn witnesses(&self) -> Vec<Vec<(f64, f64)>> {
        self.courses.values().flatten().filter(|course| course.len() > 1).cloned().collect()
    }
}

/// ln of the ratio of the amplitudes of blocks that stay where they are.
fn change(before: &[Block], now: &[Block]) -> Option<f64> {
    let stays = |(a, b): &(&Block, &Block)| {
        let flat = |block: &Block| block.distance_sd_m <= SCATTER_SHARE * block.distance_m;
        let error_m = a.distance_error_m().hypot(b.distance_error_m());
        let shift_m = (a.distance_m - b.distance_m).abs();
        let (less, more) = (a.distance_sd_m.min(b.distance_sd_m), a.distance_sd_m.max(b.distance_sd_m));
        flat(a)
            && flat(b)
            && more <= SCATTER_CHANGE * less
            && shift_m <= SHIFT_M + STANDARD_ERRORS * error_m
            && 10 * a.count.min(b.count) > 9 * a.count.max(b.count)
    };
    let ratios = before.iter().zip(now).filter(stays).map(|(a, b)| (b.mean_dn() / a.mean_dn()).ln());
    let mut ratios: Vec<f64> = ratios.filter(|ratio| ratio.is_finite()).collect();
    if ratios.len() < LEAST_BLOCKS { None } else { median(&mut ratios) }
}
