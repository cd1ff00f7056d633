//! What the frames before a frame contribute to it.

use crate::frame::{Plane, Shape, ShapeError};

/// Made by [`Stream::prepare`](super::Stream::prepare) in the order of the frames, taken by
/// [`Standardizer::apply`](super::Standardizer::apply) in any order and thread. The default has no frames before it.
#[derive(Clone, Debug, Default)]
pub struct Prepared {
    /// Filled where the plan takes means over frames.
    pub(super) mean: Option<MeanDistance>,
}

/// The distances over the last frames.
#[derive(Clone, Debug)]
pub(super) struct MeanDistance {
    /// Metres.
    pub(super) distance_m: Plane<f32>,
    /// Share of the variance of the frame's own distance that the mean leaves, 0..=1.
    pub(super) variance_left: Plane<f32>,
}

impl Default for MeanDistance {
    fn default() -> Self {
        let plane = || Plane::filled(Shape::new(0, 0), f32::NAN);
        Self { distance_m: plane(), variance_left: plane() }
    }
}

impl Prepared {
    /// Bytes that it holds.
    #[must_use]
    pub fn bytes(&self) -> usize {
        self.mean.as_ref().map_or(0, |mean| mean.distance_m.bytes() + mean.variance_left.bytes())
    }

    /// The mean, for a frame of `shape`.
    ///
    /// # Errors
    /// [`ShapeError`] when it was made of frames of another shape.
    pub(super) fn mean(&self, shape: Shape) -> Result<Option<&MeanDistance>, ShapeError> {
        let Some(mean) = &self.mean else { return Ok(None) };
        mean.distance_m.expect_shape("mean distance", shape)?;
        Ok(Some(mean))
    }
}
