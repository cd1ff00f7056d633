//! How noisy the distances of a frame are: `σ_d² = k / a²`.
//!
//! `σ_d = c / (4√2 π f) · σ_n / a` (error propagation through eq. 1). Frequency and bin noise are seldom known, and
//! the distances tell the product of both themselves: the mixed second difference of 2×2 pixels cancels every slope and
//! every edge along a row or column, and the median of its magnitude passes over the others.

use super::Image;
use crate::plane::bytes;

/// Positive f32 order like their bits; the upper 13 (the sign is 0) make bins of at most 3 % width.
const BINS: usize = 1 << 13;
const SHIFT: u32 = 18;
/// About this many differences are enough: the standard error of the median is then below 1 %.
const SAMPLES: usize = 1 << 16;
/// Fewer make no estimate.
const LEAST_SAMPLES: u32 = 16;
/// Standard deviation of a normal variable over the median of its magnitude.
const DEVIATION_OF_MEDIAN: f64 = 1.482_602_218_505_602;

/// Working memory of the estimate.
#[derive(Clone, Debug, Default)]
pub(super) struct NoiseScale {
    bins: Vec<u32>,
}

impl NoiseScale {
    pub(super) fn bytes(&self) -> usize {
        bytes(&self.bins)
    }

    /// `k` in m² DN²; 0 where the frame tells no noise, so that nothing is denoised.
    pub(super) fn estimate(&mut self, image: Image<'_>) -> f64 {
        self.bins.clear();
        self.bins.resize(BINS, 0);
        let width = image.shape.width;
        if width < 2 || image.shape.height < 2 {
            return 0.0;
        }
        let step = (image.distance_m.len() / SAMPLES).max(1);
        let row = |y: usize| y * width..(y + 1) * width;
        let mut count = 0;
        for y in (0..image.shape.height - 1).step_by(step) {
            let [distances, amplitudes] =
                [image.distance_m, image.amplitude].map(|plane| [&plane[row(y)], &plane[row(y + 1)]]);
            for x in 0..width - 1 {
                let corners = |[above, below]: [&[f32]; 2]| [above[x], above[x + 1], below[x], below[x + 1]];
                let magnitude = normalized_difference(corners(distances), corners(amplitudes));
                if magnitude.is_finite() {
                    self.bins[(magnitude.to_bits() >> SHIFT) as usize] += 1;
                    count += 1;
                }
            }
        }
        if count < LEAST_SAMPLES {
            return 0.0;
        }
        let deviation = DEVIATION_OF_MEDIAN * self.median(count);
        deviation * deviation
    }

    /// The median, taken as evenly spread within its bin.
    fn median(&self, count: u32) -> f64 {
        let mut rank = count / 2;
        for (bin, &inside) in (0u32..).zip(&self.bins) {
            if rank < inside {
                let [low, high] = [bin, bin + 1].map(|bin| f64::from(f32::from_bits(bin << SHIFT)));
                // Bin 0 holds the zeros.
                let place = (f64::from(rank) + 0.5) / f64::from(inside);
                return if bin == 0 { 0.0 } else { low + place * (high - low) };
            }
            rank -= inside;
        }
        0.0
    }
}

/// `|d₁ − d₂ − d₃ + d₄|` over its standard deviation at k = 1, √(Σ 1/a²); NaN where a pixel is invalid.
fn normalized_difference(distance_m: [f32; 4], amplitude: [f32; 4]) -> f32 {
    let [d1, d2, d3, d4] = distance_m.map(f64::from);
    let [v1, v2, v3, v4] = amplitude.map(|a| 1.0 / (f64::from(a) * f64::from(a)));
    (((d1 - d2) - (d3 - d4)).abs() / (v1 + v2 + v3 + v4).sqrt()) as f32
}
