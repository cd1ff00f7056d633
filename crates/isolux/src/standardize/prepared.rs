//! What earlier frames contribute to a frame.

use crate::frame::{Plane, Shape, ShapeError};

/// What earlier frames contribute to a frame. [`Stream::prepare`](super::Stream::prepare) fills it in the order of
/// the frames, [`Standardizer::apply`](super::Standardizer::apply) reads it in any order and thread. The default is
/// that of a first frame.
#[derive(Clone, Debug, Default)]
pub struct Prepared {
    /// Present when the plan averages distances over frames.
    pub(super) mean: Option<MeanDistance>,
    /// Ambient light of the frame, DN/µs; present when the plan corrects by one that drifts.
    pub(super) ambient_dn_per_us: Option<f64>,
    /// Multiplier of the frame; present when the plan takes out what its still pixels share.
    pub(super) relative_gain: Option<f32>,
}

/// The mean distance over the last frames.
#[derive(Clone, Debug)]
pub(super) struct MeanDistance {
    /// Metres.
    pub(super) distance_m: Plane<f32>,
    /// Variance of the mean over that of the frame's own distance, 0..=1.
    pub(super) variance_left: Plane<f32>,
}

impl Default for MeanDistance {
    fn default() -> Self {
        let plane = || Plane::filled(Shape::new(0, 0), f32::NAN);
        Self { distance_m: plane(), variance_left: plane() }
    }
}

impl Prepared {
    /// Bytes that it has allocated.
    #[must_use]
    pub fn bytes(&self) -> usize {
        self.mean.as_ref().map_or(0, |mean| mean.distance_m.bytes() + mean.variance_left.bytes())
    }

    /// The mean distance, for a frame of `shape`.
    ///
    /// # Errors
    /// [`ShapeError`] when it was made from frames of another shape.
    pub(super) fn mean(&self, shape: Shape) -> Result<Option<&MeanDistance>, ShapeError> {
        let Some(mean) = &self.mean else { return Ok(None) };
        mean.distance_m.expect_shape("mean distance", shape)?;
        Ok(Some(mean))
    }
}
