//! Merging a bracket: frames of a still scene at several integration times become one, each pixel weighted by the
//! inverse of its predicted variance.
//!
//! INVALID pixels do not count. SATURATED pixels count only where a pixel is saturated in every frame of the
//! bracket.
//!
//! A weight is the inverse of the mean variance over 3×3 pixels. The predicted variance of a single pixel depends
//! on the pixel's own noise: a value that is too low looks less noisy, and a value near 0 (at a distance near 0)
//! has a σ near 0. Single variances would therefore pull the mean down.
//!
//! The frames of a pixel may disagree by more than noise does once in a thousand times, because something moved or
//! a term does not fit. The value is then still their weighted mean, and its σ is multiplied by Birge's ratio,
//! `√(χ²/(n − 1))`.

use super::standardized::{FrameSummary, Standardized};
use super::standardizer::Standardizer;
use super::steps::specular;
use crate::frame::{PixelFlags, Shape, ShapeError};
use crate::memory::bytes;
use crate::numerics::quantile::PositiveQuantiles;
use crate::specular::SpecularRule;

/// The 0.999 quantile of the standard normal distribution.
const Z_999: f64 = 3.090_232_306_167_813;

/// Collects the frames of a bracket, one after the other; created by [`Standardizer::bracket`]. The result depends
/// only on the frames and their order.
#[derive(Clone, Debug)]
pub struct BracketMerge {
    specular: Option<SpecularRule>,
    shape: Shape,
    pixels: Vec<MergedPixel>,
    variance: Vec<f32>,
    quantiles: PositiveQuantiles,
}

/// Why a frame cannot be merged.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MergeError {
    /// The frame has no predicted standard deviation, from which the weights are computed.
    #[error(
        "no predicted standard deviation found, one for each pixel expected: the weight of a frame follows from it"
    )]
    NoSigma,
    /// Frames of one bracket that differ in shape.
    #[error(transparent)]
    Shape(#[from] ShapeError),
}

/// One pixel of the frames so far; the mean by West's recursion (1979), which avoids cancellation.
#[derive(Clone, Copy, Debug, Default)]
struct MergedPixel {
    weight: f64,
    mean: f64,
    /// Σ w (x − mean)².
    spread: f64,
    /// Σ w² σ².
    variance: f64,
    count: u16,
    /// Flags that any counting frame has, flags that all of them have, and flags of the frames that do not count.
    any: PixelFlags,
    all: PixelFlags,
    left_out: PixelFlags,
}

impl Standardizer {
    /// Splits the chain for brackets: a chain for each frame, without the step for highlights, and a
    /// [`BracketMerge`] that merges the standardized frames and then limits highlights.
    ///
    /// # Errors
    /// [`MergeError::NoSigma`] when the plan predicts no standard deviation.
    pub fn bracket(&self) -> Result<(Self, BracketMerge), MergeError> {
        if !self.predicts_sigma() {
            return Err(MergeError::NoSigma);
        }
        let (frames, specular) = self.without_highlights();
        Ok((frames, BracketMerge::new(specular)))
    }
}

impl BracketMerge {
    fn new(specular: Option<SpecularRule>) -> Self {
        let quantiles = PositiveQuantiles::default();
        Self { specular, shape: Shape::new(0, 0), pixels: Vec::new(), variance: Vec::new(), quantiles }
    }

    /// Bytes that it has allocated; known after the first frame.
    #[must_use]
    pub fn bytes(&self) -> usize {
        bytes(&self.pixels) + bytes(&self.variance) + self.quantiles.bytes()
    }

    /// Takes the next frame of the bracket.
    ///
    /// # Errors
    /// [`MergeError`] when the frame has no σ, or another shape than those before it.
    pub fn push(&mut self, frame: &Standardized) -> Result<(), MergeError> {
        let sigma = frame.sigma.as_ref().ok_or(MergeError::NoSigma)?;
        let shape = frame.amplitude.shape();
        if self.pixels.is_empty() {
            self.shape = shape;
            self.pixels.resize(shape.pixels(), MergedPixel::default());
        }
        frame.amplitude.expect_shape("standardized amplitude", self.shape)?;
        sigma.expect_shape("sigma", self.shape)?;
        self.variance.resize(shape.pixels(), f32::NAN);
        mean_variance(sigma.values(), shape, &mut self.variance);
        let values = frame.amplitude.values().iter().zip(frame.flags.values());
        let noise = sigma.values().iter().zip(&self.variance);
        for ((pixel, (&value, &flags)), (&sigma, &variance)) in self.pixels.iter_mut().zip(values).zip(noise)
        {
            pixel.push(f64::from(value), f64::from(sigma), 1.0 / f64::from(variance), flags);
        }
        Ok(())
    }

    /// Ends the bracket and writes the merged frame into `out`; the next push begins another bracket. A pixel is
    /// INVALID where it was INVALID in every frame, and LOW_SIGNAL where it was in all frames that count. It has
    /// every other flag of any frame that counts.
    pub fn finish(&mut self, out: &mut Standardized) {
        out.reshape(self.shape, true);
        self.pixels.resize(self.shape.pixels(), MergedPixel::default());
        let sigma = out.sigma.iter_mut().flat_map(|sigma| sigma.values_mut());
        let planes = out.amplitude.values_mut().iter_mut().zip(sigma).zip(out.flags.values_mut());
        for (((value, sigma), flags), pixel) in planes.zip(&self.pixels) {
            (*value, *sigma, *flags) = pixel.finish();
        }
        self.pixels.clear();
        let rule = self.specular;
        let specular_cutoff = rule.and_then(|rule| specular::limit(rule, out, &mut self.quantiles));
        out.summary = FrameSummary { specular_cutoff, ..FrameSummary::of(out.flags.values()) };
    }
}

impl MergedPixel {
    fn push(&mut self, value: f64, sigma: f64, weight: f64, flags: PixelFlags) {
        let known = sigma > 0.0 && weight > 0.0 && sigma.is_finite() && weight.is_finite();
        let saturated = flags.contains(PixelFlags::SATURATED);
        let others_are_better = self.count > 0 && saturated && !self.any.contains(PixelFlags::SATURATED);
        if flags.contains(PixelFlags::INVALID) || !known || others_are_better {
            self.left_out |= flags;
            return;
        }
        if !saturated && self.any.contains(PixelFlags::SATURATED) {
            *self = Self { left_out: self.left_out | self.any, ..Self::default() };
        }
        let mean = self.mean;
        self.weight += weight;
        self.mean += (value - mean) * (weight / self.weight);
        self.spread += weight * (value - mean) * (value - self.mean);
        self.variance += weight * weight * sigma * sigma;
        self.all = if self.count == 0 { flags } else { self.all & flags };
        self.any |= flags;
        self.count = self.count.saturating_add(1);
    }

    fn finish(&self) -> (f32, f32, PixelFlags) {
        if self.count == 0 {
            return (f32::NAN, f32::NAN, self.left_out | PixelFlags::INVALID);
        }
        let freedom = f64::from(self.count - 1);
        let disagree = self.count > 1 && self.spread > unlikely(freedom);
        let birge = if disagree { self.spread / freedom } else { 1.0 };
        let sigma = (birge * self.variance).sqrt() / self.weight;
        let low = self.all & PixelFlags::LOW_SIGNAL;
        (self.mean as f32, sigma as f32, self.any.difference(PixelFlags::LOW_SIGNAL) | low)
    }
}

/// The 0.999 quantile of χ² with `freedom` degrees of freedom (Wilson and Hilferty 1931; within 4 %).
fn unlikely(freedom: f64) -> f64 {
    let ninth = 2.0 / (9.0 * freedom);
    freedom * (1.0 - ninth + Z_999 * ninth.sqrt()).powi(3)
}

/// Mean of σ² over those of the 3×3 pixels around each pixel that have a σ; NaN where the pixel itself has none.
fn mean_variance(sigma: &[f32], shape: Shape, out: &mut [f32]) {
    let (height, width) = (shape.height, shape.width);
    for (index, out) in out.iter_mut().enumerate() {
        *out = f32::NAN;
        if sigma[index].is_nan() {
            continue;
        }
        let (row, column) = shape.place(index);
        let (mut sum, mut count) = (0.0, 0.0);
        for row in row.saturating_sub(1)..(row + 2).min(height) {
            for sigma in &sigma[row * width + column.saturating_sub(1)..row * width + (column + 2).min(width)]
            {
                let known = !sigma.is_nan();
                sum += if known { sigma * sigma } else { 0.0 };
                count += if known { 1.0 } else { 0.0 };
            }
        }
        *out = sum / count;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::Plane;

    /// A frame of one row: value, σ and flags of each pixel.
    fn frame(pixels: &[(f32, f32, PixelFlags)]) -> Standardized {
        let shape = Shape::new(1, pixels.len());
        let mut frame = Standardized::new(shape);
        let column = |pick: fn(&(f32, f32, PixelFlags)) -> f32| {
            Plane::from_vec(shape, pixels.iter().map(pick).collect()).unwrap()
        };
        frame.amplitude = column(|pixel| pixel.0);
        frame.sigma = Some(column(|pixel| pixel.1));
        frame.flags = Plane::from_vec(shape, pixels.iter().map(|pixel| pixel.2).collect()).unwrap();
        frame
    }

    fn merge(frames: &[Standardized]) -> Standardized {
        let mut merge = BracketMerge::new(None);
        let mut out = Standardized::new(Shape::new(0, 0));
        // Twice: nothing of a bracket remains for the next.
        for _ in 0..2 {
            frames.iter().for_each(|frame| merge.push(frame).unwrap());
            merge.finish(&mut out);
        }
        out
    }

    const CLEAN: PixelFlags = PixelFlags::empty();
    const SATURATED: PixelFlags = PixelFlags::SATURATED;

    #[test]
    fn pixels_are_weighted_by_their_inverse_variance() {
        let out = merge(&[frame(&[(10.0, 1.0, CLEAN)]), frame(&[(12.0, 2.0, CLEAN)])]);
        // Weights 1 and 1/4: (10 + 3) / 1.25, σ = 1/√1.25.
        assert!((out.amplitude.values()[0] - 10.4).abs() < 1e-5);
        assert!((out.sigma.unwrap().values()[0] - 1.25f32.sqrt().recip()).abs() < 1e-6);
    }

    #[test]
    fn saturated_pixels_count_only_where_nothing_else_is_there() {
        let bright = [
            (9.0, 0.1, SATURATED),
            (9.0, 0.1, SATURATED),
            (f32::NAN, f32::NAN, SATURATED | PixelFlags::INVALID),
        ];
        let dim = [(10.0, 1.0, CLEAN), (11.0, 0.1, SATURATED), (10.0, 1.0, CLEAN)];
        for frames in [[frame(&bright), frame(&dim)], [frame(&dim), frame(&bright)]] {
            let out = merge(&frames);
            assert_eq!(out.amplitude.values()[0], 10.0);
            assert!((out.amplitude.values()[1] - 10.0).abs() < 1.0);
            assert_eq!(out.amplitude.values()[2], 10.0);
            assert_eq!(out.flags.values(), [CLEAN, SATURATED, CLEAN]);
        }
    }

    #[test]
    fn what_no_frame_has_is_invalid_and_says_why() {
        let invalid = (f32::NAN, f32::NAN, PixelFlags::INVALID | PixelFlags::TIME_OUT_OF_RANGE);
        let low = (5.0, 1.0, PixelFlags::LOW_SIGNAL);
        let far = (5.0, 1.0, PixelFlags::DISTANCE_OUT_OF_RANGE);
        let out = merge(&[frame(&[invalid, low, low, invalid]), frame(&[invalid, low, far, far])]);
        assert!(out.amplitude.values()[0].is_nan() && out.sigma.unwrap().values()[0].is_nan());
        let flags = [invalid.2, low.2, far.2, far.2];
        assert_eq!(out.flags.values(), flags);
    }

    #[test]
    fn disagreement_widens_sigma_and_chance_does_not() {
        let of = |values: [f32; 2]| merge(&values.map(|value| frame(&[(value, 1.0, CLEAN)])));
        let plain = 0.5f32.sqrt();
        // Differences of 4 and 6 are 2.8 and 4.2 standard deviations of a difference; 3.3 is one in a thousand.
        assert!((of([10.0, 14.0]).sigma.unwrap().values()[0] - plain).abs() < 1e-6);
        let moved = of([10.0, 16.0]);
        assert_eq!(moved.amplitude.values()[0], 13.0);
        // χ² = 2·3² = 18 with one degree of freedom.
        assert!((moved.sigma.unwrap().values()[0] - plain * 18f32.sqrt()).abs() < 1e-5);
    }

    #[test]
    fn the_limit_of_chance_is_that_of_the_tables() {
        // Quantiles of χ² at 0.999.
        for (freedom, expected) in [(1.0, 10.828), (2.0, 13.816), (4.0, 18.467), (9.0, 27.877)] {
            assert!((unlikely(freedom) / expected - 1.0).abs() < 0.04, "{freedom}: {}", unlikely(freedom));
        }
    }

    #[test]
    fn frames_without_sigma_or_of_another_shape_are_refused() {
        let mut merge = BracketMerge::new(None);
        assert_eq!(merge.push(&Standardized::new(Shape::new(1, 1))), Err(MergeError::NoSigma));
        merge.push(&frame(&[(1.0, 1.0, CLEAN)])).unwrap();
        assert!(matches!(merge.push(&frame(&[(1.0, 1.0, CLEAN); 2])), Err(MergeError::Shape(_))));
    }
}
