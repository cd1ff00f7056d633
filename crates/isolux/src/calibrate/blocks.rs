//! The image cut into blocks, so that what changes in a part of it can be told from what changes everywhere.

use crate::frame::{Frame, PixelFlags};

/// The image is cut into this many blocks along each side.
pub(super) const SIDE: usize = 12;

/// What one frame shows in one block.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Block {
    /// Sum of the valid amplitudes, DN.
    pub(super) sum_dn: f32,
    /// Number of valid pixels.
    pub(super) count: u32,
    /// Mean distance of the valid pixels, m; NaN without one.
    pub(super) distance_m: f32,
    /// Standard deviation of these distances, m: noise and what the block shows.
    pub(super) distance_sd_m: f32,
}

impl Block {
    /// Mean of the valid amplitudes, DN; NaN without one.
    pub(super) fn mean_dn(&self) -> f64 {
        f64::from(self.sum_dn) / f64::from(self.count)
    }

    /// Standard error of the mean distance, m.
    pub(super) fn distance_error_m(&self) -> f32 {
        self.distance_sd_m / (self.count.max(1) as f32).sqrt()
    }
}

/// The block of every pixel, row by row.
pub(super) fn block_of(index: usize, height: usize, width: usize) -> usize {
    let (row, column) = (index / width.max(1), index % width.max(1));
    (row * SIDE / height.max(1)) * SIDE + column * SIDE / width.max(1)
}

/// Blocks beside a block, and itself.
pub(super) fn around(block: usize) -> impl Iterator<Item = usize> {
    let near = |place: usize| place.saturating_sub(1)..(place + 2).min(SIDE);
    near(block / SIDE).flat_map(move |row| near(block % SIDE).map(move |column| row * SIDE + column))
}

/// Measures every block of a frame.
pub(super) fn blocks(frame: &Frame) -> Box<[Block]> {
    let shape = frame.shape();
    let distances = frame.distance_m.as_ref().map(|plane| plane.values());
    // Sums of amplitude, its count, distance, its square and its count.
    let mut sums = vec![[0.0f64; 5]; SIDE * SIDE];
    for (index, (&amplitude, flags)) in frame.amplitude.values().iter().zip(frame.flags.values()).enumerate()
    {
        if flags.intersects(PixelFlags::INVALID | PixelFlags::SATURATED) {
            continue;
        }
        let sum = &mut sums[block_of(index, shape.height, shape.width)];
        sum[0] += f64::from(amplitude);
        sum[1] += 1.0;
        let distance_m = distances.map_or(f64::NAN, |values| f64::from(values[index]));
        if distance_m > 0.0 && distance_m.is_finite() {
            sum[2] += distance_m;
            sum[3] += distance_m * distance_m;
            sum[4] += 1.0;
        }
    }
    let block = |[sum_dn, count, distance, square, distances]: [f64; 5]| {
        let mean = distance / distances;
        Block {
            sum_dn: sum_dn as f32,
            count: count as u32,
            distance_m: mean as f32,
            distance_sd_m: (square / distances - mean * mean).max(0.0).sqrt() as f32,
        }
    };
    sums.into_iter().map(block).collect()
}
