//! Working memory for one frame at a time.

use super::steps::response::Corrected;
use crate::denoise::Denoiser;
use crate::memory::bytes;
use crate::numerics::quantile::PositiveQuantiles;
use crate::surface::Incidence;

/// Working memory of [`Standardizer::apply`](super::Standardizer::apply). Use one for each thread: it is empty at
/// first and allocates only when the shape of the frames changes.
#[derive(Clone, Debug, Default)]
pub struct Workspace {
    pub(super) corrected: Corrected,
    /// Multipliers over integration time, where each pixel has its own.
    pub(super) gains: Vec<f32>,
    /// Signal-to-noise ratio of each pixel, where the noise of the distance is estimated from the frame.
    pub(super) signal_to_noise: Vec<f32>,
    pub(super) denoiser: Denoiser,
    pub(super) incidence: Incidence,
    pub(super) quantiles: PositiveQuantiles,
}

impl Workspace {
    /// Bytes that it has allocated: the memory that one frame needs besides itself and its result. Known after the
    /// first frame.
    #[must_use]
    pub fn bytes(&self) -> usize {
        self.corrected.bytes()
            + bytes(&self.gains)
            + bytes(&self.signal_to_noise)
            + self.denoiser.bytes()
            + self.incidence.bytes()
            + self.quantiles.bytes()
    }
}
