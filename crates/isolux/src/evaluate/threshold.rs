//! Fixed-threshold masks over integration times: whether one threshold selects the same pixels at every integration
//! time.

use serde::Serialize;

use super::outcome::{Outcome, Unavailable};
use super::tally::Tally;

/// Intersection over union of the mask `A > threshold` in a frame and in the reference frame, over their jointly
/// valid pixels, for the frames whose integration time is not the reference's.
///
/// The threshold is Otsu's of the reference frame's ln A: it falls into the gap between materials where there
/// is one, which is where a user would put it. A median would lie in the densest part of the values and
/// measure noise. Frames where neither mask holds a pixel are left out.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ThresholdIou {
    /// Smallest over frames, 0..=1.
    pub minimum: f64,
    /// Mean over frames, 0..=1.
    pub mean: f64,
    /// The threshold, in the unit of the values.
    pub threshold: f64,
    /// Frames that entered.
    pub frames: u32,
    /// Jointly valid pixels / pixels of the compared frames, 0..=1.
    pub valid_fraction: f64,
}

/// Collects the overlap frame by frame.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct IouMeter(Tally);

impl IouMeter {
    /// Takes in a frame and the reference, pixel by pixel; NaN = unusable.
    pub(super) fn push(&mut self, reference: &[f32], frame: &[f32], threshold: f64) {
        let (mut joint, mut both, mut either) = (0, 0usize, 0usize);
        for (&reference, &frame) in reference.iter().zip(frame) {
            if !reference.is_nan() && !frame.is_nan() {
                joint += 1;
                let masks = (f64::from(reference) > threshold, f64::from(frame) > threshold);
                both += usize::from(masks.0 && masks.1);
                either += usize::from(masks.0 || masks.1);
            }
        }
        if either > 0 {
            self.0.push(both as f64 / either as f64, joint, frame.len());
        }
    }

    pub(super) fn finish(&self, threshold: f64) -> Outcome<ThresholdIou> {
        let summary = self.0.summary().ok_or(Unavailable::EmptyMasks)?;
        Ok(ThresholdIou {
            minimum: summary.minimum,
            mean: summary.mean,
            threshold,
            frames: summary.frames,
            valid_fraction: summary.valid_fraction,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn overlap_counts_jointly_valid_pixels_only() {
        let nan = f32::NAN;
        let mut meter = IouMeter::default();
        // Masks 1 1 0 0 and 1 0 1 0 on the four joint pixels: 1 of 3.
        meter.push(&[9.0, 9.0, 1.0, 1.0, nan, 9.0], &[9.0, 1.0, 9.0, 1.0, 9.0, nan], 5.0);
        // Nothing in either mask: no statement.
        meter.push(&[1.0, 1.0, 1.0, 1.0, nan, 1.0], &[1.0, 1.0, 1.0, 1.0, 1.0, nan], 5.0);
        let found = meter.finish(5.0).unwrap();
        assert_eq!((found.minimum, found.mean, found.frames), (1.0 / 3.0, 1.0 / 3.0, 1));
        assert_eq!(found.valid_fraction, 4.0 / 6.0);
    }
}
