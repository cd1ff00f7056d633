//! W1 distance between log histograms: how far the values of the image shift with the integration time.

use serde::Serialize;

use super::outcome::{Outcome, Unavailable};
use super::tally::Tally;

/// First Wasserstein distance between the distributions of ln A in a frame and in the reference frame, over
/// their jointly valid pixels, for the frames whose integration time is not the reference's.
///
/// `∫ |F⁻¹(q) − G⁻¹(q)| dq` of the empirical quantile functions, no bins: with equal counts the mean
/// difference of the sorted values.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct HistogramDistance {
    /// Mean over frames, natural-log units (0.01 ≈ 1 %).
    pub mean_ln: f64,
    /// Largest over frames, natural-log units.
    pub maximum_ln: f64,
    /// Frames that entered.
    pub frames: u32,
    /// Jointly valid pixels / pixels of the compared frames, 0..=1.
    pub valid_fraction: f64,
}

/// Mean `|ln a − ln b|` over the pairs of two ascending lists of equal length; `None` when they are empty.
fn w1_ln(first: &[f32], second: &[f32]) -> Option<f64> {
    let differences = first.iter().zip(second).map(|(&a, &b)| (f64::from(a) / f64::from(b)).ln().abs());
    (!first.is_empty()).then(|| differences.sum::<f64>() / first.len() as f64)
}

/// Collects the distances frame by frame.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct HistogramMeter(Tally);

impl HistogramMeter {
    /// Takes in the jointly valid values of the reference and of a frame, each ascending.
    pub(super) fn push(&mut self, reference: &[f32], frame: &[f32], pixels: usize) {
        if let Some(distance) = w1_ln(reference, frame) {
            self.0.push(distance, frame.len(), pixels);
        }
    }

    pub(super) fn finish(&self) -> Outcome<HistogramDistance> {
        let summary = self.0.summary().ok_or(Unavailable::NoValidPixels)?;
        Ok(HistogramDistance {
            mean_ln: summary.mean,
            maximum_ln: summary.maximum,
            frames: summary.frames,
            valid_fraction: summary.valid_fraction,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_gain_moves_every_quantile_by_its_logarithm() {
        let found = w1_ln(&[1.0, 2.0, 4.0], &[2.0, 4.0, 8.0]).unwrap();
        assert!((found - std::f64::consts::LN_2).abs() < 1e-15);
        assert_eq!(w1_ln(&[], &[]), None);
    }

    #[test]
    fn equals_the_area_between_the_distribution_functions() {
        let (first, second) = ([1.0f32, 2.0, 3.0, 7.0], [1.5f32, 2.5, 2.75, 20.0]);
        // The other form of W1, ∫ |F(x) − G(x)| dx, summed over the steps of the merged values.
        let mut all: Vec<f64> = first.iter().chain(&second).map(|&value| f64::from(value).ln()).collect();
        all.sort_by(f64::total_cmp);
        let cumulative = |list: &[f32], x: f64| {
            list.iter().filter(|&&value| f64::from(value).ln() <= x).count() as f64 / list.len() as f64
        };
        let area: f64 = all
            .windows(2)
            .map(|step| {
                (cumulative(&first, step[0]) - cumulative(&second, step[0])).abs() * (step[1] - step[0])
            })
            .sum();
        assert!((w1_ln(&first, &second).unwrap() - area).abs() < 1e-14);
    }
}
