//! The parameters of the term: those of its tiers.

use serde::{Deserialize, Serialize};

use super::ambient::AmbientResponse;
use super::amplitude::AmplitudeResponse;
use super::intensity::IntensityResponse;
use super::phase_samples::PhaseSampleResponse;
use super::pixel::PixelResponse;
use super::scalar::ScalarResponse;
use super::tier::ResponseTier;
use crate::terms::check::{Check, ParameterError, Parameters};

/// Everything that is known of the response, tier by tier.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Response {
    /// Version of this term's parameters.
    pub version: u32,
    /// From the mean of the image.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scalar: Option<ScalarResponse>,
    /// From the amplitude of the pixel.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub amplitude: Option<AmplitudeResponse>,
    /// Of one static scene.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pixel: Option<PixelResponse>,
    /// From amplitude and distance.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ambient: Option<AmbientResponse>,
    /// From intensity and amplitude.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub intensity: Option<IntensityResponse>,
    /// From the raw bins.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub phase_samples: Option<PhaseSampleResponse>,
    /// What the user should know or record better.
    pub warnings: Vec<String>,
}

impl Response {
    /// Parameter version that this library writes.
    pub const VERSION: u32 = 1;

    /// A response without any tier.
    #[must_use]
    pub(crate) fn empty() -> Self {
        Self {
            version: Self::VERSION,
            scalar: None,
            amplitude: None,
            pixel: None,
            ambient: None,
            intensity: None,
            phase_samples: None,
            warnings: Vec::new(),
        }
    }

    /// The tiers that were fitted and hold for any scene, the best first.
    pub fn tiers(&self) -> impl Iterator<Item = ResponseTier> {
        let tiers = [
            self.phase_samples.as_ref().map(|_| ResponseTier::PhaseSamples),
            self.intensity.as_ref().map(|_| ResponseTier::Intensity),
            self.ambient.as_ref().map(|_| ResponseTier::Ambient),
            self.amplitude.as_ref().map(|_| ResponseTier::Amplitude),
            self.scalar.as_ref().map(|_| ResponseTier::Scalar),
        ];
        tiers.into_iter().flatten()
    }

    /// Refuses parameters that no fit can have written.
    ///
    /// # Errors
    /// [`ParameterError`] names the field.
    pub fn check(&self) -> Result<(), ParameterError> {
        self.check_at(&Check::of(Self::NAME))
    }
}

impl Parameters for Response {
    const NAME: &'static str = "response";

    fn check_at(&self, here: &Check<'_>) -> Result<(), ParameterError> {
        here.version(self.version, Self::VERSION)?;
        here.optional(&self.scalar)?;
        here.optional(&self.amplitude)?;
        here.optional(&self.pixel)?;
        here.optional(&self.ambient)?;
        here.optional(&self.intensity)?;
        here.optional(&self.phase_samples)
    }
}
