//! Do frames share an exposure? What all still pixels share from frame to frame is no property of the scene.
//!
//! A pixel that sees the same surface at the same distance measures the same light. Where all such pixels change by one
//! common factor, the exposure (or the scale of the stored values) changed. A [`Course`] follows that factor from frame
//! to frame and tells whether the recorded integration times explain it; [`Spans`] notices frames that were stretched
//! one by one to the same limits.
//!
//! Pixels are sampled, at most [`Grid::SAMPLES`] of a frame. Movement does not fool it: only pixels whose distance
//! stayed are compared, and the parts of the image must agree on one factor.

mod course;
mod look;
mod pair;
mod relative;
mod spans;
#[cfg(test)]
mod tests;

pub(crate) use course::{Course, Times};
pub use course::{ExposureClaim, ExposureCourse};
pub(crate) use look::{Grid, Look};
pub use relative::{ExposureSurvey, RelativeExposure};
pub use spans::SpannedFrames;
pub(crate) use spans::Spans;
