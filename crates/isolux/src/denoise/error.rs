//! Why a frame's distance cannot be denoised.

use crate::frame::ShapeError;

/// Why a frame's distance cannot be denoised.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum DenoiseError {
    /// The planes differ in shape.
    #[error(transparent)]
    Shape(#[from] ShapeError),
    /// The frame has no distance.
    #[error("no distance found, a plane of metres expected: denoising needs it")]
    DistanceMissing,
}
