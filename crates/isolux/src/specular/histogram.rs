//! `histogram`: the cutoff is the highest value with at least `t_thresh` occurrences.
//!
//! The paper leaves the bins and the threshold open. A float image with unit bins has no qualifying bin, so they
//! are settled here: 256 bins on [0, min(max, 4·P99)], smoothed by a 3-bin box, and a threshold that grows with
//! the image.

use super::maximum::maximum;
use crate::numerics::quantile::PositiveQuantiles;

/// Bins of the histogram.
const BINS: usize = 256;
/// Share of the valid pixels that a bin needs when no count is given.
const DEFAULT_SHARE: f64 = 5e-4;
/// A bin of one pixel is a stray pixel, however small the image.
const LEAST_OCCURRENCES: f64 = 2.0;
/// No more than the top 2 % may be called specular.
const LOWEST_CUTOFF_QUANTILE: f64 = 0.98;

/// Parameters of the histogram rule.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct HistogramRule {
    /// Occurrences that make a value trustworthy; `None`: max(2, 5·10⁻⁴ of the valid pixels).
    pub occurrences: Option<u32>,
}

impl HistogramRule {
    pub(super) fn parameters(&self) -> String {
        match self.occurrences {
            Some(count) => format!("highest of {BINS} bins with at least {count} pixels"),
            None => {
                format!("highest of {BINS} bins with at least max(2, {DEFAULT_SHARE} of the valid pixels)")
            }
        }
    }

    /// Upper edge of the highest bin with enough pixels, never below the 98th percentile. Pixels beyond the last
    /// bin do not make it qualify.
    pub(super) fn cutoff(&self, values: &[f32], quantiles: &mut PositiveQuantiles) -> Option<f32> {
        let ([lowest_cutoff, p99], count) = quantiles.at(values, [LOWEST_CUTOFF_QUANTILE, 0.99])?;
        let end = maximum(values).min(4.0 * p99);
        let per_bin = f64::from(end) / BINS as f64;
        let bins_per_dn = (1.0 / per_bin) as f32;
        let bins = count_bins(values, end, bins_per_dn);
        let needed = match self.occurrences {
            Some(occurrences) => f64::from(occurrences),
            None => LEAST_OCCURRENCES.max(DEFAULT_SHARE * count as f64),
        };
        let highest = (0..BINS).rev().find(|&bin| smoothed(&bins, bin) >= needed)?;
        let edge = (per_bin * (highest + 1) as f64) as f32;
        Some(edge.max(lowest_cutoff))
    }
}

/// Counts the values of 0 to `end`. Neighbouring pixels fall into the same bin; tables of their own for every
/// fourth one spare the processor from waiting for the last increment.
fn count_bins(values: &[f32], end: f32, bins_per_dn: f32) -> [u32; BINS] {
    let mut lanes = [[0u32; BINS]; 4];
    for chunk in values.chunks(lanes.len()) {
        for (lane, &value) in lanes.iter_mut().zip(chunk) {
            if value > 0.0 && value <= end {
                lane[((value * bins_per_dn) as usize).min(BINS - 1)] += 1;
            }
        }
    }
    std::array::from_fn(|bin| lanes.iter().map(|lane| lane[bin]).sum())
}

/// Mean of a bin and its neighbours; outside the histogram there are none.
fn smoothed(bins: &[u32; BINS], bin: usize) -> f64 {
    let neighbours = &bins[bin.saturating_sub(1)..=(bin + 1).min(BINS - 1)];
    neighbours.iter().map(|&count| f64::from(count)).sum::<f64>() / 3.0
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cutoff(rule: HistogramRule, values: &[f32]) -> Option<f32> {
        rule.cutoff(values, &mut PositiveQuantiles::default())
    }

    /// 10 000 values spread evenly over 50..150.
    fn matt() -> Vec<f32> {
        (0..10_000).map(|i| 50.0 + 0.01 * i as f32).collect()
    }

    #[test]
    fn a_few_spots_are_cut_just_above_the_matt_values() {
        let mut values = matt();
        values.extend([2000.0, 3000.0, 5000.0]);
        let cutoff = cutoff(HistogramRule::default(), &values).unwrap();
        // One bin of min(max, 4 P99)/256 = 596/256 = 2.3, and one more by the smoothing.
        assert!((150.0..155.0).contains(&cutoff), "{cutoff}");
    }

    #[test]
    fn an_image_without_highlights_loses_nothing() {
        let values = matt();
        let cutoff = cutoff(HistogramRule::default(), &values).unwrap();
        assert!(values.iter().all(|value| *value <= cutoff * (1.0 + f32::EPSILON)));
    }

    #[test]
    fn a_bright_quarter_is_no_highlight() {
        let values: Vec<f32> =
            (0..1000).map(|i| if i % 4 == 0 { 900.0 } else { 100.0 } + (i % 7) as f32).collect();
        let cutoff = cutoff(HistogramRule::default(), &values).unwrap();
        assert!(values.iter().all(|value| *value <= cutoff * (1.0 + f32::EPSILON)));
    }

    #[test]
    fn nothing_qualifies_in_an_empty_image_or_above_an_unreachable_count() {
        assert_eq!(cutoff(HistogramRule::default(), &[f32::NAN, 0.0, -1.0]), None);
        assert_eq!(cutoff(HistogramRule { occurrences: Some(u32::MAX) }, &matt()), None);
    }
}
