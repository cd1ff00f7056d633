//! How good a standardization is: figures for a recording before and after, with the share of pixels behind each.
//!
//! The evaluation streams: an [`Evaluator`] keeps a fixed number of planes (about 100 bytes a pixel), whatever
//! the number of frames. It takes two passes over a recording:
//!
//! 1. read the integration times alone and let [`nearest_reference`] pick the reference frame;
//! 2. give that frame to [`Evaluator::set_reference`], then every frame to [`Evaluator::push`], the raw
//!    amplitude to one evaluator and the standardized amplitude to another, and both to [`Comparison::new`].
//!
//! Masking improves most figures: a method that drops the difficult pixels looks better. So each figure has its
//! valid fraction, the share of the values of all its frames that entered. To compare on the same pixels, give
//! the raw evaluator the flags of the standardized frame.
//!
//! The figures over integration times assume a still scene: they call every change with exposure a defect. A
//! figure that the recording does not determine is not 0 but [`Unavailable`], which says why.
//!
//! ```
//! use isolux::evaluate::{Comparison, EvaluationFrame, EvaluationSettings, Evaluator, nearest_reference};
//! use isolux::{Frame, IntegrationTime, Plane, Shape};
//!
//! let shape = Shape::new(4, 4);
//! let times_us = [2000.0, 4000.0, 8000.0];
//! let frames = times_us.map(|time_us| {
//!     let mut frame = Frame::new(shape);
//!     let exposure = time_us as f32 / 100.0;
//!     frame.amplitude = Plane::from_fn(shape, |row, column| exposure * (1 + row + column) as f32);
//!     frame.integration_time_us = IntegrationTime::PerFrame(time_us);
//!     frame
//! });
//! let standardized = Plane::from_fn(shape, |row, column| (1 + row + column) as f32);
//!
//! let mut before = Evaluator::new(shape, EvaluationSettings::default());
//! let mut after = Evaluator::new(shape, EvaluationSettings::default());
//! if let Some(index) = nearest_reference(times_us.map(Some), 4100.0) {
//!     let frame = &frames[index];
//!     before.set_reference(&EvaluationFrame::of_raw(frame))?;
//!     after.set_reference(&EvaluationFrame::of_standardized(frame, &standardized, &frame.flags))?;
//! }
//! for frame in &frames {
//!     before.push(&EvaluationFrame::of_raw(frame))?;
//!     after.push(&EvaluationFrame::of_standardized(frame, &standardized, &frame.flags))?;
//! }
//! let comparison = Comparison::new(&before, &after);
//! assert!(comparison.before.pixel_cv.is_ok_and(|cv| cv.median > 0.5));
//! assert!(comparison.after.pixel_cv.is_ok_and(|cv| cv.median < 1e-6));
//! # Ok::<(), isolux::ShapeError>(())
//! ```

mod comparison;
mod evaluation;
mod evaluator;
mod fraction;
mod frame_to_frame;
mod histogram;
mod image_cv;
mod input;
mod noise;
mod otsu;
mod outcome;
mod pixel_cv;
mod reference;
mod runs;
mod settings;
mod sigma;
mod slope;
mod tally;
#[cfg(test)]
mod tests;
mod threshold;

pub use comparison::{Better, Comparison, ComparisonRow};
pub use evaluation::Evaluation;
pub use evaluator::Evaluator;
pub use frame_to_frame::FrameToFrame;
pub use histogram::HistogramDistance;
pub use image_cv::ImageCv;
pub use input::{EvaluationFrame, nearest_reference};
pub use noise::{Noise, NoiseMethod};
pub use otsu::OtsuShift;
pub use outcome::{Outcome, Unavailable};
pub use pixel_cv::{PixelCv, SnrStratum};
pub use settings::EvaluationSettings;
pub use sigma::{CoverageStratum, SigmaCoverage, SigmaTally};
pub use slope::DistanceSlope;
pub use threshold::ThresholdIou;
