//! Estimates the noise of a frame's distances: `σ_d² = k / a²`, with k in m² DN².
//!
//! `σ_d = c / (4√2 π f) · σ_n / a` (error propagation through eq. 1). Frequency and bin noise are seldom known, so
//! k is estimated from the distances: the mixed second difference of 2×2 pixels cancels every slope and every edge
//! along a row or column, and the median of its magnitude ignores other edges.

use super::image::Image;
use crate::numerics::bit_histogram::BitHistogram;
use crate::numerics::statistics::SIGMA_PER_MAD;

type Bins = BitHistogram<18>;

/// About this many differences are enough: the standard error of the median is then below 1 %.
const SAMPLES: usize = 1 << 16;
/// Least number of differences for an estimate.
const LEAST_SAMPLES: u32 = 16;
/// Working memory of the estimate.
#[derive(Clone, Debug, Default)]
pub(super) struct NoiseScale {
    /// Bins of 3 % width at most.
    bins: Bins,
}

impl NoiseScale {
    pub(super) fn bytes(&self) -> usize {
        self.bins.bytes()
    }

    /// `k` in m² DN²; 0 where the frame shows no noise, so that nothing is denoised.
    pub(super) fn estimate(&mut self, image: Image<'_>) -> f64 {
        self.bins.clear();
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
                    self.bins.add(magnitude);
                    count += 1;
                }
            }
        }
        if count < LEAST_SAMPLES {
            return 0.0;
        }
        let deviation = SIGMA_PER_MAD * self.median(count);
        deviation * deviation
    }

    /// The median; the values of a bin are assumed to be evenly spread.
    fn median(&self, count: u32) -> f64 {
        // Bin 0 holds the zeros.
        let Some((bin, rank)) = self.bins.find(count as usize / 2).filter(|(bin, _)| *bin > 0) else {
            return 0.0;
        };
        let [low, high] = [bin, bin + 1].map(|bin| f64::from(Bins::start(bin)));
        let place = (rank as f64 + 0.5) / f64::from(self.bins.count(bin));
        low + place * (high - low)
    }
}

/// `|d₁ − d₂ − d₃ + d₄|` over its standard deviation at k = 1, √(Σ 1/a²); NaN where a pixel is invalid.
fn normalized_difference(distance_m: [f32; 4], amplitude: [f32; 4]) -> f32 {
    let [d1, d2, d3, d4] = distance_m.map(f64::from);
    let [v1, v2, v3, v4] = amplitude.map(|a| 1.0 / (f64::from(a) * f64::from(a)));
    (((d1 - d2) - (d3 - d4)).abs() / (v1 + v2 + v3 + v4).sqrt()) as f32
}
