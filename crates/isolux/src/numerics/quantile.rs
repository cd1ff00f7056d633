//! Exact order statistics of positive f32 values by counting, without sorting the image or allocating for each.

use super::bit_histogram::BitHistogram;
use crate::memory;

/// Bins of under 1 % width: few values share the bin of a quantile, and only these need to be sorted out.
type Bins = BitHistogram<16>;

/// Working memory for order statistics, kept between images.
/// Empty until it is used.
#[derive(Clone, Debug, Default)]
pub(crate) struct PositiveQuantiles {
    bins: Bins,
    /// Bits of the values that share the bin of a wanted quantile.
    candidates: Vec<u32>,
}

impl PositiveQuantiles {
    /// Bytes that it holds.
    pub(crate) fn bytes(&self) -> usize {
        self.bins.bytes() + memory::bytes(&self.candidates)
    }

    /// Makes room for images of `pixels`, so that no image allocates, however its values lie.
    pub(crate) fn reserve(&mut self, pixels: usize) {
        self.candidates.clear();
        self.candidates.reserve_exact(pixels);
    }

    /// For each fraction (clamped to 0..=1) the value at rank `floor(fraction · (count − 1))` of the positive finite
    /// values, and their count; all other values are passed over. `None` when there are none.
    pub(crate) fn at<const N: usize>(
        &mut self,
        values: &[f32],
        fractions: [f64; N],
    ) -> Option<([f32; N], usize)> {
        let count = self.count(values);
        let last = count.checked_sub(1)?;
        let rank = |fraction: f64| (fraction.clamp(0.0, 1.0) * last as f64) as usize;
        let places = fractions.map(|fraction| self.bins.find(rank(fraction)).unwrap_or((0, 0)));
        self.collect(values, places.map(|(bin, _)| bin));
        let found = places.map(|(bin, rank)| self.select(bin, rank));
        Some((found, count))
    }

    fn count(&mut self, values: &[f32]) -> usize {
        self.bins.clear();
        let mut count = 0;
        for &value in values {
            if is_positive(value) {
                self.bins.add(value);
                count += 1;
            }
        }
        count
    }

    fn collect<const N: usize>(&mut self, values: &[f32], bins: [u32; N]) {
        self.candidates.clear();
        for &value in values {
            let bits = value.to_bits();
            // Only a positive finite value has the upper bits of one, but for those just below infinity.
            if bins.contains(&Bins::bin(bits)) && is_positive(value) {
                self.candidates.push(bits);
            }
        }
    }

    fn select(&mut self, bin: u32, rank: usize) -> f32 {
        // Values of lower bins come first, whichever bins were collected.
        let below = self.candidates.iter().filter(|bits| Bins::bin(**bits) < bin).count();
        match (below + rank) < self.candidates.len() {
            true => f32::from_bits(*self.candidates.select_nth_unstable(below + rank).1),
            false => f32::NAN,
        }
    }
}

fn is_positive(value: f32) -> bool {
    value > 0.0 && value < f32::INFINITY
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn equals_sorting(
            values in prop::collection::vec(prop_oneof![prop::num::f32::ANY, 1f32..1.02], 0..200),
            first in 0.0..=1.0f64,
            second in 0.0..=1.0f64,
        ) {
            let mut sorted: Vec<f32> = values.iter().copied().filter(|value| is_positive(*value)).collect();
            sorted.sort_by(f32::total_cmp);
            let at = |fraction: f64| sorted[(fraction * (sorted.len() - 1) as f64) as usize];
            let expected = (!sorted.is_empty()).then(|| ([at(first), at(second)], sorted.len()));
            prop_assert_eq!(PositiveQuantiles::default().at(&values, [first, second]), expected);
        }
    }
}
