//! Images of the tested exposures, and how much their pixels vary.

use isolux::statistics::quantile;

use crate::measure::coefficient_of_variation;

/// Frames whose mean counts as one tested exposure: what is measured is the compression, not the noise.
pub(super) const TEST_FRAMES: u32 = 64;

/// Mean standardized image of each test exposure, NaN where a pixel is invalid or clipped in any of its frames.
#[derive(Clone, Debug, Default)]
pub(super) struct Stack {
    exposures: Vec<Vec<f64>>,
    /// Unclipped pixels of all exposures.
    pub(super) unclipped: usize,
    /// Those of them that have a value.
    pub(super) valid: usize,
}

impl Stack {
    /// Adds one frame, the `place`-th of its exposure.
    pub(super) fn add(&mut self, place: u32, values: impl Iterator<Item = f64>, clipped: &[bool]) {
        if place == 0 {
            self.exposures.push(vec![0.0; clipped.len()]);
        }
        let Some(means) = self.exposures.last_mut() else { return };
        for ((mean, value), clipped) in means.iter_mut().zip(values).zip(clipped) {
            *mean += if *clipped { f64::NAN } else { value / f64::from(TEST_FRAMES) };
        }
        if place + 1 == TEST_FRAMES {
            self.unclipped += clipped.iter().filter(|clipped| !**clipped).count();
            self.valid += means.iter().filter(|mean| mean.is_finite()).count();
        }
    }

    /// Median and 95th percentile over the pixels of the coefficient of variation over the exposures, where `mask` has
    /// a value and the pixel has one at half of the exposures or more.
    pub(super) fn variation(&self, mask: &Self) -> [f64; 2] {
        let pixels = self.exposures.first().map_or(0, Vec::len);
        let of_pixel = |pixel: usize| {
            let pairs = self.exposures.iter().zip(&mask.exposures);
            let values = pairs.filter(|(_, mask)| mask[pixel].is_finite()).map(|(own, _)| own[pixel]);
            let values: Vec<f64> = values.filter(|value| value.is_finite()).collect();
            (2 * values.len() >= self.exposures.len()).then(|| coefficient_of_variation(&values))
        };
        let mut all: Vec<f64> = (0..pixels).filter_map(of_pixel).filter(|cv| cv.is_finite()).collect();
        [0.5, 0.95].map(|share| quantile(&mut all, share).unwrap_or(f64::NAN))
    }
}
