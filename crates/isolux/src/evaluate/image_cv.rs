//! Coefficient of variation of the whole image over integration times.

use serde::Serialize;

use super::fraction::fraction;
use super::outcome::{Outcome, Unavailable};
use super::runs::Runs;

/// Population coefficient of variation, over integration times, of the image's mean.
///
/// The mean of a frame is taken relative to that of the reference frame, both over their jointly valid pixels:
/// where pixels drop out (saturated at long times, say) the means of different pixels are not compared. Without
/// dropouts this is the coefficient of variation of the plain means. Frames are averaged within runs of equal
/// time first.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ImageCv {
    /// Standard deviation / mean over integration times, dimensionless.
    pub cv: f64,
    /// Runs of frames of one integration time.
    pub runs: u32,
    /// Jointly valid pixels / pixels of the frames with a known time, 0..=1.
    pub valid_fraction: f64,
}

/// Collects the relative means frame by frame.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ImageCvMeter {
    runs: Runs,
    joint: u64,
    pixels: u64,
}

impl ImageCvMeter {
    /// Takes in a frame and the reference, pixel by pixel; NaN = unusable.
    pub(super) fn push(&mut self, reference: &[f32], frame: &[f32], time_us: f32, same_time_ratio: f64) {
        let (mut joint, mut frame_sum, mut reference_sum) = (0u64, 0.0, 0.0);
        for (&reference, &frame) in reference.iter().zip(frame) {
            if !reference.is_nan() && !frame.is_nan() {
                joint += 1;
                frame_sum += f64::from(frame);
                reference_sum += f64::from(reference);
            }
        }
        if joint > 0 {
            self.runs.push(frame_sum / reference_sum, time_us, same_time_ratio);
        }
        self.joint += joint;
        self.pixels += frame.len() as u64;
    }

    pub(super) fn finish(&self) -> Outcome<ImageCv> {
        Ok(ImageCv {
            cv: self.runs.coefficient_of_variation().ok_or(Unavailable::NoPixelAtTwoTimes)?,
            runs: self.runs.moments().count(),
            valid_fraction: fraction(self.joint, self.pixels),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dropouts_do_not_shift_the_mean() {
        let mut meter = ImageCvMeter::default();
        let reference = [1.0, 2.0, 100.0];
        meter.push(&reference, &reference, 10.0, 1.01);
        // The bright pixel is lost, the others keep their values: no change at all.
        meter.push(&reference, &[1.0, 2.0, f32::NAN], 20.0, 1.01);
        let found = meter.finish().unwrap();
        assert_eq!((found.cv, found.runs), (0.0, 2));
        assert_eq!(found.valid_fraction, 5.0 / 6.0);
    }

    #[test]
    fn equals_the_cv_of_the_plain_means_without_dropouts() {
        let mut meter = ImageCvMeter::default();
        let reference = [2.0, 4.0];
        for (frame, time_us) in [([2.0, 4.0], 10.0), ([4.0, 8.0], 20.0)] {
            meter.push(&reference, &frame, time_us, 1.01);
        }
        // Means 3 and 6: standard deviation 1.5 over 4.5.
        assert!((meter.finish().unwrap().cv - 1.0 / 3.0).abs() < 1e-15);
    }
}
