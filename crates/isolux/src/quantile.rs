//! Exact order statistics of positive f32 values in two counting passes, without sorting or allocating.

/// Working memory for [`PositiveQuantiles`], kept between images.
#[derive(Clone, Debug)]
pub(crate) struct PositiveQuantiles {
    /// How many values share their upper 16 bits. Positive floats order like their bits, and have no sign bit.
    upper: Vec<u32>,
    lower: Vec<u32>,
    count: usize,
}

impl PositiveQuantiles {
    pub(crate) fn new() -> Self {
        Self { upper: vec![0; 1 << 15], lower: vec![0; 1 << 16], count: 0 }
    }

    /// Counts the positive finite values of `values`; all others are passed over.
    pub(crate) fn count(&mut self, values: &[f32]) -> usize {
        self.upper.fill(0);
        self.count = 0;
        for value in positive(values) {
            self.upper[(value.to_bits() >> 16) as usize] += 1;
            self.count += 1;
        }
        self.count
    }

    /// The value at rank `floor(fraction · (count − 1))` of the values last counted, which must be passed again
    /// unchanged. `None` when there were none. `fraction` is clamped to 0..=1.
    pub(crate) fn at(&mut self, values: &[f32], fraction: f64) -> Option<f32> {
        let last = self.count.checked_sub(1)?;
        let rank = (fraction.clamp(0.0, 1.0) * last as f64) as usize;
        let (upper, rank) = find(&self.upper, rank)?;
        self.lower.fill(0);
        for value in positive(values) {
            let bits = value.to_bits();
            if (bits >> 16) as usize == upper {
                self.lower[(bits & 0xffff) as usize] += 1;
            }
        }
        let (lower, _) = find(&self.lower, rank)?;
        Some(f32::from_bits(((upper as u32) << 16) | lower as u32))
    }
}

fn positive(values: &[f32]) -> impl Iterator<Item = f32> {
    values.iter().copied().filter(|value| *value > 0.0 && value.is_finite())
}

/// The bin that holds the value of this rank, and its rank within the bin.
fn find(counts: &[u32], mut rank: usize) -> Option<(usize, usize)> {
    for (bin, &count) in counts.iter().enumerate() {
        match rank.checked_sub(count as usize) {
            Some(rest) => rank = rest,
            None => return Some((bin, rank)),
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn equals_sorting(values in prop::collection::vec(prop::num::f32::ANY, 0..200), fraction in 0.0..=1.0f64) {
            let mut sorted: Vec<f32> = positive(&values).collect();
            sorted.sort_by(f32::total_cmp);
            let mut quantiles = PositiveQuantiles::new();
            prop_assert_eq!(quantiles.count(&values), sorted.len());
            let rank = (fraction * sorted.len().saturating_sub(1) as f64) as usize;
            prop_assert_eq!(quantiles.at(&values, fraction), sorted.get(rank).copied());
        }
    }
}
