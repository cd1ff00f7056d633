//! Slope of ln A over ln d: −2 where the inverse-square law is uncorrected, 0 where distance no longer shows.

use std::collections::BinaryHeap;

use serde::Serialize;

use crate::frame::IntegrationTime;
use crate::numerics::hash::splitmix64;
use crate::numerics::statistics::{quantile, theil_sen};

use super::fraction::fraction;
use super::input::Times;
use super::outcome::{Outcome, Unavailable};
use super::{EvaluationFrame, EvaluationSettings};

/// Pairs below which a median slope is no statement.
const MINIMUM_PAIRS: usize = 10;

/// Theil–Sen slope of ln A on ln d (Theil 1950, Sen 1968).
///
/// A fixed pseudo-random sample of the valid pixels of all frames is taken, the same on every run; the slope is
/// the median over its pairs of one target label and one integration time whose distances differ by at least
/// `minimum_pair_distance_ratio`. Without a target channel all pixels count as one material: true of a flat
/// target that fills the image, a rough guide elsewhere.
///
/// The interval is Sen's: it assumes independent pixels. Errors that the pixels of a frame share (an uneven
/// illumination, a distance offset) make it too narrow.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct DistanceSlope {
    /// d ln A / d ln d, dimensionless.
    pub slope: f64,
    /// Lower end of the 95 % confidence interval.
    pub low_95: f64,
    /// Upper end of the 95 % confidence interval.
    pub high_95: f64,
    /// Pixels in the sample.
    pub sample_pixels: usize,
    /// Pairs of them that entered.
    pub pairs: usize,
    /// 95 % over 5 % quantile of the distances of the group that spans most.
    pub distance_ratio: f64,
    /// True when pixels were paired by target label.
    pub labelled: bool,
    /// Pixels that the sample was drawn from / pixels of all frames, 0..=1.
    pub valid_fraction: f64,
}

/// A pixel of the sample. The order is that of the fields; ranks are unique, so it is that of the rank.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Sampled {
    rank: u64,
    label: u8,
    time_us: f32,
    ln_distance: f64,
    ln_value: f64,
}

impl Eq for Sampled {}

impl PartialOrd for Sampled {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Sampled {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.rank.cmp(&other.rank)
    }
}

/// Keeps the pixels whose hashed number is smallest: a uniform sample of bounded size, without a generator's
/// state, and the same whatever else is evaluated.
#[derive(Clone, Debug)]
pub(super) struct SlopeSample {
    capacity: usize,
    kept: BinaryHeap<Sampled>,
    number: u64,
    eligible: u64,
    distance_seen: bool,
    target_seen: bool,
}

impl SlopeSample {
    pub(super) fn new(capacity: usize) -> Self {
        let kept = BinaryHeap::new();
        Self { capacity, kept, number: 0, eligible: 0, distance_seen: false, target_seen: false }
    }

    /// Takes in a frame; NaN in `usable` = unusable.
    pub(super) fn push(&mut self, usable: &[f32], frame: &EvaluationFrame<'_>, times: Times<'_>) {
        let first_number = self.number;
        self.number += usable.len() as u64;
        self.target_seen |= frame.target.is_some();
        let Some(distance_m) = frame.distance_m else { return };
        self.distance_seen = true;
        let labels = frame.target.map(|target| target.values());
        for (index, (&value, &distance_m)) in usable.iter().zip(distance_m.values()).enumerate() {
            let label = labels.map(|labels| labels[index]);
            let measured = !value.is_nan() && distance_m > 0.0 && distance_m.is_finite();
            if measured && label != Some(0) {
                self.eligible += 1;
                let rank = splitmix64(first_number + index as u64);
                if self.has_room_for(rank) {
                    self.keep(Sampled {
                        rank,
                        label: label.unwrap_or(0),
                        time_us: times.at(index),
                        ln_distance: f64::from(distance_m).ln(),
                        ln_value: f64::from(value).ln(),
                    });
                }
            }
        }
    }

    fn has_room_for(&self, rank: u64) -> bool {
        self.kept.len() < self.capacity || self.kept.peek().is_some_and(|last| rank < last.rank)
    }

    fn keep(&mut self, pixel: Sampled) {
        self.kept.push(pixel);
        if self.kept.len() > self.capacity {
            self.kept.pop();
        }
    }

    pub(super) fn finish(&self, settings: &EvaluationSettings) -> Outcome<DistanceSlope> {
        self.require_pixels()?;
        let groups = self.groups(settings.same_time_ratio);
        let distance_ratio = groups.iter().filter_map(|group| distance_ratio(group)).fold(1.0, f64::max);
        let minimum = settings.minimum_distance_ratio;
        if distance_ratio < minimum {
            return Err(Unavailable::DistanceSpanTooSmall { found: distance_ratio, minimum });
        }
        let minimum_step = settings.minimum_pair_distance_ratio.ln();
        let fit = theil_sen(groups.iter().map(Vec::as_slice), minimum_step);
        let found = fit.map_or(0, |fit| fit.pairs);
        let fit = fit.filter(|fit| fit.pairs >= MINIMUM_PAIRS);
        let fit = fit.ok_or(Unavailable::TooFewPairs { found, minimum: MINIMUM_PAIRS })?;
        Ok(DistanceSlope {
            slope: fit.slope,
            low_95: fit.low_95,
            high_95: fit.high_95,
            sample_pixels: self.kept.len(),
            pairs: fit.pairs,
            distance_ratio,
            labelled: self.target_seen,
            valid_fraction: fraction(self.eligible, self.number),
        })
    }

    fn require_pixels(&self) -> Result<(), Unavailable> {
        match (self.distance_seen, self.eligible, self.target_seen) {
            (false, ..) => Err(Unavailable::NoDistance),
            (true, 0, true) => Err(Unavailable::NoLabelledPixels),
            (true, 0, false) => Err(Unavailable::NoValidPixels),
            (true, 1.., _) => Ok(()),
        }
    }

    /// (ln d, ln A) of the pixels of one label and one integration time: across times the raw amplitude differs
    /// for another reason than distance.
    fn groups(&self, same_time_ratio: f64) -> Vec<Vec<(f64, f64)>> {
        let mut pixels: Vec<Sampled> = self.kept.iter().copied().collect();
        pixels.sort_unstable_by(|a, b| {
            (a.label.cmp(&b.label)).then(a.time_us.total_cmp(&b.time_us)).then(a.rank.cmp(&b.rank))
        });
        let mut groups: Vec<Vec<(f64, f64)>> = Vec::new();
        let mut group_start: Option<Sampled> = None;
        for pixel in pixels {
            let joins = group_start.is_some_and(|start| {
                start.label == pixel.label
                    && IntegrationTime::same(start.time_us, pixel.time_us, same_time_ratio)
            });
            let point = (pixel.ln_distance, pixel.ln_value);
            match groups.last_mut() {
                Some(group) if joins => group.push(point),
                _ => {
                    group_start = Some(pixel);
                    groups.push(vec![point]);
                }
            }
        }
        groups
    }
}

/// 95 % over 5 % quantile of the distances: stray pixels do not widen it.
fn distance_ratio(group: &[(f64, f64)]) -> Option<f64> {
    let mut ln_distances: Vec<f64> = group.iter().map(|&(ln_distance, _)| ln_distance).collect();
    let far = quantile(&mut ln_distances, 0.95)?;
    Some((far - quantile(&mut ln_distances, 0.05)?).exp())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sample_is_bounded_and_even() {
        let mut sample = SlopeSample::new(1000);
        for number in 0..100_000 {
            let rank = splitmix64(number);
            if sample.has_room_for(rank) {
                let early = u8::from(number < 50_000);
                sample.keep(Sampled { rank, label: early, time_us: 0.0, ln_distance: 0.0, ln_value: 0.0 });
            }
        }
        let early = sample.kept.iter().filter(|pixel| pixel.label == 1).count();
        assert_eq!(sample.kept.len(), 1000);
        // Binomial, σ = √(1000/4) = 16; five σ.
        assert!(early.abs_diff(500) < 80, "{early}");
    }
}
