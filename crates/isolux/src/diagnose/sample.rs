//! A sample of pixels of bounded size, the same on every run.

use std::collections::BinaryHeap;

use crate::numerics::hash::splitmix64;

/// Most pixels that are kept: 60 bytes each.
const CAPACITY: usize = 1 << 16;

/// What was seen of one pixel of one frame. NaN = unknown or invalid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Observed {
    pub(super) frame: u32,
    pub(super) block: u16,
    /// Target label, 0 = none.
    pub(super) label: u8,
    pub(super) time_us: f32,
    pub(super) distance_m: f32,
    /// Squared distance from the principal point, in half diagonals squared.
    pub(super) radius2: f32,
    /// Finite and positive.
    pub(super) amplitude: f32,
    pub(super) vendor: f32,
    /// Eq. 1 of the phase samples.
    pub(super) demodulated: f32,
}

#[derive(Clone, Copy, Debug)]
struct Ranked {
    rank: u64,
    observed: Observed,
}

impl PartialEq for Ranked {
    fn eq(&self, other: &Self) -> bool {
        self.rank == other.rank
    }
}

impl Eq for Ranked {}

impl PartialOrd for Ranked {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Ranked {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.rank.cmp(&other.rank)
    }
}

/// Keeps the pixels whose hashed number (over all frames) is smallest: a uniform sample.
#[derive(Clone, Debug, Default)]
pub(super) struct Sample {
    kept: BinaryHeap<Ranked>,
    frame_start: u64,
}

impl Sample {
    /// True when the pixel `index` of this frame would be kept.
    pub(super) fn admits(&self, index: usize) -> bool {
        let rank = splitmix64(self.frame_start + index as u64);
        self.kept.len() < CAPACITY || self.kept.peek().is_some_and(|last| rank < last.rank)
    }

    pub(super) fn keep(&mut self, index: usize, observed: Observed) {
        self.kept.push(Ranked { rank: splitmix64(self.frame_start + index as u64), observed });
        if self.kept.len() > CAPACITY {
            self.kept.pop();
        }
    }

    pub(super) fn next_frame(&mut self, pixels: usize) {
        self.frame_start += pixels as u64;
    }

    /// The sample, in an order that depends on nothing but the pixels' numbers.
    pub(super) fn observed(&self) -> Vec<Observed> {
        let mut kept: Vec<Ranked> = self.kept.iter().copied().collect();
        kept.sort_unstable();
        kept.into_iter().map(|ranked| ranked.observed).collect()
    }
}
