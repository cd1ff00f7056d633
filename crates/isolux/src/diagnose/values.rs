//! The values that the amplitude takes: clipping at the largest one, coarse steps.

use serde::Serialize;

use super::sample::Observed;
use crate::frame::PixelFlags;

/// More pixels than this at the largest value are no coincidence where others are spread.
const PILE_UP_PIXELS: f64 = 8.0;
/// ... and this many times what the other large values have.
const PILE_UP_RATIO: f64 = 5.0;
/// The values from this fraction of the largest on say what is usual.
const TOP: f64 = 0.8;
/// Up to this many different values are coarse steps: 8 bits.
const COARSE_LEVELS: usize = 256;
/// Sample values needed for each level before few levels mean anything.
const VALUES_PER_LEVEL: usize = 8;

/// Counts of pixels, exact over all frames.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ValueMeter {
    pixels: u64,
    valid: u64,
    saturated: u64,
    largest: f32,
    at_largest: u64,
}

/// Which values the amplitude takes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Values {
    /// Valid pixels / pixels, 0..=1.
    pub valid_fraction: f64,
    /// Pixels that carry the saturation code or have a saturated phase sample / pixels, 0..=1.
    pub saturated_fraction: f64,
    /// Largest valid amplitude, DN.
    pub maximum_dn: f64,
    /// Pixels pile up at the largest value.
    pub pile_up: Option<PileUp>,
    /// Number of different values, where they are so few that the amplitude is coarse (8 bits or less).
    pub levels: Option<usize>,
}

/// Many pixels share the largest value.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PileUp {
    /// That value, DN.
    pub value_dn: f64,
    /// Pixels at it / valid pixels, 0..=1.
    pub fraction: f64,
}

impl ValueMeter {
    pub(super) fn push(&mut self, amplitude: f32, flags: PixelFlags) {
        self.pixels += 1;
        self.saturated += u64::from(flags.contains(PixelFlags::SATURATED));
        if flags.contains(PixelFlags::INVALID) {
            return;
        }
        self.valid += 1;
        if amplitude > self.largest {
            (self.largest, self.at_largest) = (amplitude, 0);
        }
        self.at_largest += u64::from(amplitude == self.largest);
    }

    /// `None` where no pixel is valid.
    pub(super) fn finish(&self, sample: &[Observed]) -> Option<Values> {
        if self.valid == 0 {
            return None;
        }
        let mut sorted: Vec<f32> = sample.iter().map(|observed| observed.amplitude).collect();
        let levels = distinct(&mut sorted);
        let pixels = self.pixels as f64;
        Some(Values {
            valid_fraction: self.valid as f64 / pixels,
            saturated_fraction: self.saturated as f64 / pixels,
            maximum_dn: f64::from(self.largest),
            pile_up: self.pile_up(&sorted).filter(|_| levels > 1),
            levels: Some(levels).filter(|&n| n <= COARSE_LEVELS && sorted.len() >= VALUES_PER_LEVEL * n),
        })
    }

    fn pile_up(&self, sorted: &[f32]) -> Option<PileUp> {
        // What one value of the sample stands for in all frames.
        let share = self.valid as f64 / sorted.len().max(1) as f64;
        let usual = PILE_UP_RATIO * share * usual_count(sorted, self.largest) + PILE_UP_PIXELS;
        let (count, value_dn) = (self.at_largest as f64, f64::from(self.largest));
        (count > usual).then(|| PileUp { value_dn, fraction: count / self.valid as f64 })
    }
}

/// The largest of the values, where more of them share it than chance allows.
pub(super) fn pile_up_value(values: impl Iterator<Item = f32>) -> Option<f32> {
    let mut sorted: Vec<f32> = values.filter(|value| value.is_finite()).collect();
    let levels = distinct(&mut sorted);
    let largest = *sorted.last()?;
    let count = sorted.iter().rev().take_while(|&&value| value == largest).count() as f64;
    (levels > 1 && count > PILE_UP_RATIO * usual_count(&sorted, largest) + PILE_UP_PIXELS).then_some(largest)
}

/// Sorts the values and counts the different ones.
fn distinct(values: &mut [f32]) -> usize {
    values.sort_unstable_by(f32::total_cmp);
    values.chunk_by(|a, b| a == b).count()
}

/// Mean number of values that share one level just below the largest; at least 1.
fn usual_count(sorted: &[f32], largest: f32) -> f64 {
    let from = sorted.partition_point(|&value| f64::from(value) < TOP * f64::from(largest));
    let to = sorted.partition_point(|&value| value < largest);
    let levels = sorted[from..to].chunk_by(|a, b| a == b).count();
    if levels == 0 { 1.0 } else { (to - from) as f64 / levels as f64 }
}
