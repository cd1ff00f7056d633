//! Counts of f32 values by their upper bits: positive floats order like their bits, so that ranks are found without
//! sorting.

use crate::memory;

/// A histogram of values that are at least 0 (not −0) and finite. A bin holds the values that share all bits but the
/// lowest `SHIFT`; its relative width is 2^(SHIFT − 23) at most. Empty until [`Self::clear`] is called.
#[derive(Clone, Debug, Default)]
pub(crate) struct BitHistogram<const SHIFT: u32> {
    counts: Vec<u32>,
}

impl<const SHIFT: u32> BitHistogram<SHIFT> {
    /// The sign is 0.
    const BINS: usize = 1 << (31 - SHIFT);

    /// Sets all counts to 0.
    pub(crate) fn clear(&mut self) {
        self.counts.clear();
        self.counts.resize(Self::BINS, 0);
    }

    /// Bytes that it holds.
    pub(crate) fn bytes(&self) -> usize {
        memory::bytes(&self.counts)
    }

    /// The bin of a value with these bits.
    pub(crate) fn bin(bits: u32) -> u32 {
        bits >> SHIFT
    }

    /// Least value of a bin.
    pub(crate) fn start(bin: u32) -> f32 {
        f32::from_bits(bin << SHIFT)
    }

    /// Counts one value.
    pub(crate) fn add(&mut self, value: f32) {
        self.counts[Self::bin(value.to_bits()) as usize] += 1;
    }

    /// Number of values in a bin.
    pub(crate) fn count(&self, bin: u32) -> u32 {
        self.counts[bin as usize]
    }

    /// The bin that holds the value of this rank, counted from 0, and its rank within the bin; `None` where there are
    /// fewer values.
    pub(crate) fn find(&self, mut rank: usize) -> Option<(u32, usize)> {
        for (bin, &count) in (0u32..).zip(&self.counts) {
            match rank.checked_sub(count as usize) {
                Some(rest) => rank = rest,
                None => return Some((bin, rank)),
            }
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranks_are_found_within_the_bins_of_their_values() {
        let mut histogram = BitHistogram::<18>::default();
        assert_eq!(histogram.find(0), None);
        histogram.clear();
        for value in [3.0, 0.0, 1.0, 1.0, 1.001] {
            histogram.add(value);
        }
        let of = |value: f32| BitHistogram::<18>::bin(value.to_bits());
        let expected = [(of(0.0), 0), (of(1.0), 0), (of(1.0), 1), (of(1.0), 2), (of(3.0), 0)];
        assert_eq!([0, 1, 2, 3, 4].map(|rank| histogram.find(rank)), expected.map(Some));
        assert_eq!((histogram.find(5), histogram.count(of(1.0))), (None, 3));
        assert_eq!(BitHistogram::<18>::start(of(1.001)), 1.0);
    }
}
