//! What an exposure sweep keeps of each frame.

use std::collections::BTreeMap;

use crate::calibrate::blocks::Block;

/// Sum and number of the positive amplitudes of a frame, and the numbers of zeros and of saturated pixels.
#[derive(Clone, Debug, Default)]
pub(super) struct FrameSums {
    /// Number of the frame in the recording.
    pub(super) number: usize,
    /// Sum of the positive amplitudes; what parts of the image that moved would have is filled in.
    pub(super) sum: f64,
    pub(super) positive: usize,
    pub(super) zero: usize,
    pub(super) saturated: usize,
    pub(super) blocks: Box<[Block]>,
    /// Blocks that show something else than usual.
    pub(super) moved: Vec<usize>,
    /// It departs from its repeats and counts nowhere.
    pub(super) stray: bool,
}

/// All frames by their time, and in the order of recording within a time.
pub(super) type Times = BTreeMap<u64, Vec<FrameSums>>;

/// The frames that count, each with its time (µs), in the order of times.
pub(super) fn kept(times: &Times) -> Vec<(f64, &FrameSums)> {
    times
        .iter()
        .flat_map(|(&bits, frames)| frames.iter().map(move |frame| (f64::from_bits(bits), frame)))
        .filter(|(_, frame)| !frame.stray)
        .collect()
}

impl FrameSums {
    /// Pixels that enter the mean.
    pub(super) fn count(&self, dead: usize) -> usize {
        self.positive + self.zero.saturating_sub(dead)
    }

    pub(super) fn mean(&self, dead: usize) -> f64 {
        self.sum / self.count(dead) as f64
    }
}
