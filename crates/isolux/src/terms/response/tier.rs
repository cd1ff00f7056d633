//! The tiers of evidence.

use crate::frame::Channels;
use crate::names::named;

named! {
    /// How a recording tells the fill of its pixels.
    #[non_exhaustive]
    pub enum ResponseTier: "response tier" {
        /// By the integration time alone, as the table does.
        Scalar = "scalar",
        /// By the amplitude alone, for scenes without strong ambient light.
        Amplitude = "amplitude",
        /// By the time, for the static scene of the sweep and no other; never chosen unless asked for.
        Pixel = "pixel",
        /// By amplitude and distance, because a surface reflects ambient light and the camera's own alike.
        Ambient = "ambient",
        /// By intensity and amplitude.
        Intensity = "intensity",
        /// By the raw bins; repairs the distance too.
        PhaseSamples = "phase_samples",
    }
}

impl ResponseTier {
    /// The channels that it needs besides amplitude and integration time.
    #[must_use]
    pub fn channels(self) -> Channels {
        match self {
            Self::Scalar | Self::Amplitude | Self::Pixel => Channels::empty(),
            Self::Ambient => Channels::DISTANCE,
            Self::Intensity => Channels::INTENSITY,
            Self::PhaseSamples => Channels::PHASE_SAMPLES,
        }
    }
}
