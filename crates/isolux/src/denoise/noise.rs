//! How noisy the distances of a frame are: `σ_d² = k / a²`.
//!
//! `σ_d = c / (4√2 π f) · σ_n / a` (error propagation through eq. 1). Frequency and bin noise are seldom known, and
//! the distances tell the product of both themselves: second differences along the rows cancel every even slope,
//! and the median of their magnitudes passes over edges.

use super::Image;

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
    /// `k` in m² DN²; 0 where the frame tells no noise, so that nothing is denoised.
    pub(super) fn estimate(&mut self, image: Image<'_>) -> f64 {
        self.bins.clear();
        self.bins.resize(BINS, 0);
        let step = (image.distance_m.len() / SAMPLES).max(1);
        let width = image.shape.width.max(1);
        let rows = image.distance_m.chunks(width).zip(image.amplitude.chunks(width)).step_by(step);
        let mut count = 0;
        for (distances, amplitudes) in rows {
            for (d, a) in distances.windows(3).zip(amplitudes.windows(3)) {
                let magnitude = normalized_second_difference(d, a);
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

/// `|d₋ − 2 d + d₊|` over its standard deviation at k = 1, √(1/a₋² + 4/a² + 1/a₊²); NaN where a pixel is invalid.
fn normalized_second_difference(d: &[f32], a: &[f32]) -> f32 {
    let [d0, d1, d2] = [d[0], d[1], d[2]].map(f64::from);
    let [v0, v1, v2] = [a[0], a[1], a[2]].map(|a| 1.0 / (f64::from(a) * f64::from(a)));
    ((d0 - 2.0 * d1 + d2).abs() / (v0 + 4.0 * v1 + v2).sqrt()) as f32
}
