//! Otsu's threshold, and how far it moves with the integration time.

use serde::Serialize;

use super::outcome::{Outcome, Unavailable};
use super::tally::Tally;

/// A split must be better than an earlier one by this factor less one to replace it: ties are then decided by
/// order, not by rounding, and a scaled image is split at the same pixels.
const TIE_TOLERANCE: f64 = 1e-9;

/// How far Otsu's threshold of a frame lies from that of the reference frame, over their jointly valid pixels:
/// `|ln θ_frame − ln θ_reference|`, for the frames whose integration time is not the reference's.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct OtsuShift {
    /// Mean over frames, natural-log units (0.01 ≈ 1 %).
    pub mean_ln: f64,
    /// Largest over frames, natural-log units.
    pub maximum_ln: f64,
    /// Frames that entered.
    pub frames: u32,
    /// Jointly valid pixels / pixels of the compared frames, 0..=1.
    pub valid_fraction: f64,
}

/// Natural logarithm of the threshold that divides `ascending` positive values best by the logarithm: the split
/// with the largest variance between the classes (Otsu 1979), halfway between its two neighbours. The values
/// themselves are split, not a histogram, so the result scales with the image. `None` for fewer than two
/// different values.
pub(super) fn threshold_ln(ascending: &[f32]) -> Option<f64> {
    let ln = |value: f32| f64::from(value).ln();
    let count = ascending.len() as f64;
    let mean = ascending.iter().map(|&value| ln(value)).sum::<f64>() / count;
    let mut best: Option<(f64, f64)> = None;
    let mut sum = 0.0;
    for (position, pair) in ascending.windows(2).enumerate() {
        let low = ln(pair[0]);
        sum += low - mean;
        if pair[0] < pair[1] {
            let below = (position + 1) as f64;
            // n times the between-class variance of centred values.
            let between = sum * sum / (below * (count - below));
            if best.is_none_or(|(most, _)| between > most * (1.0 + TIE_TOLERANCE)) {
                best = Some((between, 0.5 * (low + ln(pair[1]))));
            }
        }
    }
    best.map(|(_, threshold)| threshold)
}

/// Collects the shifts frame by frame.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct OtsuMeter(Tally);

impl OtsuMeter {
    /// Takes in the jointly valid values of the reference and of a frame, each ascending.
    pub(super) fn push(&mut self, reference: &[f32], frame: &[f32], pixels: usize) {
        if let (Some(reference_ln), Some(frame_ln)) = (threshold_ln(reference), threshold_ln(frame)) {
            self.0.push((frame_ln - reference_ln).abs(), frame.len(), pixels);
        }
    }

    pub(super) fn finish(&self) -> Outcome<OtsuShift> {
        let summary = self.0.summary().ok_or(Unavailable::NoThreshold)?;
        Ok(OtsuShift {
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
    fn two_clusters_are_divided_halfway_between_their_edges() {
        let found = threshold_ln(&[1.0, 1.1, 1.2, 30.0, 31.0]).unwrap().exp();
        assert!((found - (1.2f64 * 30.0).sqrt()).abs() < 1e-5, "{found}");
    }

    #[test]
    fn nothing_to_divide_is_none() {
        assert_eq!(threshold_ln(&[]), None);
        assert_eq!(threshold_ln(&[3.0]), None);
        assert_eq!(threshold_ln(&[3.0, 3.0, 3.0]), None);
    }

    #[test]
    fn the_split_has_the_largest_between_class_variance() {
        let values: Vec<f32> = (1..60u16).map(|i| 3.0 + f32::from(i * i % 97)).collect();
        let mut ascending = values.clone();
        ascending.sort_by(f32::total_cmp);
        let logs: Vec<f64> = ascending.iter().map(|&value| f64::from(value).ln()).collect();
        // The textbook form, w₀ w₁ (μ₀ − μ₁)², over every threshold between neighbours.
        let between = |threshold: f64| {
            let (low, high): (Vec<f64>, Vec<f64>) = logs.iter().partition(|&&value| value < threshold);
            if low.is_empty() || high.is_empty() {
                return 0.0;
            }
            let mean = |part: &[f64]| part.iter().sum::<f64>() / part.len() as f64;
            low.len() as f64 * high.len() as f64 * (mean(&low) - mean(&high)).powi(2)
        };
        let best = logs.windows(2).map(|pair| between(0.5 * (pair[0] + pair[1]))).fold(0.0, f64::max);
        let found = between(threshold_ln(&ascending).unwrap());
        assert!(found >= best * (1.0 - 1e-8), "{found} {best}");
    }
}
