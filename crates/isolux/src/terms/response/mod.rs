//! `response`: corrects amplitudes for saturation, in up to five tiers that differ in the channel that shows the
//! fill of a pixel.
//!
//! A pixel saturates by its total charge, ambient light included, not by its amplitude: `A_lin = A / f′(x)`, with x
//! the fill that its well would have without saturation (eq. 3 of Stürmer, Penne and Hornegger 2008; methods,
//! section 2). How precisely x is known depends on the channels of the camera. Each tier is fitted when an exposure
//! sweep has its channels, independently of the others.
//!
//! | tier | the fill is known from | corrects |
//! |---|---|---|
//! | [`ScalarResponse`] | mean of the image | what a lookup table does |
//! | [`AmplitudeResponse`] | amplitude of the pixel | compression without ambient light |
//! | [`PixelResponse`] | static scene at several times | compression of each pixel of that scene |
//! | [`IntensityResponse`] | DC image | compression by any light |
//! | [`PhaseSampleResponse`] | the four raw bins | the same, without approximation, and that of the distance |
//!
//! A saturation-corrected (linearised) amplitude, DN, is what an ideal pixel that never saturates would deliver.
//! Times `t_ref / t`, it is what that pixel would deliver at the reference time. A pixel that saturates at the
//! reference time is therefore corrected there too: its multiplier is not 1.

mod amplitude;
mod fill_time;
mod full_well;
mod intensity;
mod map_rows;
mod means;
mod phase_samples;
mod pixel;
mod scalar;
mod solve;
mod still;
mod well;

use serde::{Deserialize, Serialize};

pub use amplitude::AmplitudeResponse;
pub(crate) use amplitude::PlannedAmplitude;
pub use full_well::FullWell;
pub use intensity::IntensityResponse;
pub(crate) use intensity::PlannedIntensity;
pub use means::{AmplitudeStack, PixelMeans, PixelSeries};
pub use phase_samples::PhaseSampleResponse;
pub(crate) use phase_samples::PlannedBins;
pub use pixel::PixelResponse;
pub(crate) use pixel::PlannedPixels;
pub use scalar::ScalarResponse;
pub use well::SoftWell;

use super::check::{Check, ParameterError, Parameters};
use crate::frame::Channels;
use crate::names::named;

/// The fitted tiers of the response.
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
    /// From intensity and amplitude.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub intensity: Option<IntensityResponse>,
    /// From the raw bins.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub phase_samples: Option<PhaseSampleResponse>,
    /// Warnings of the fit: what the user should know or record better.
    pub warnings: Vec<String>,
}

/// Why a tier could not be fitted.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ResponseError {
    /// Too few integration times.
    #[error(
        "{found} usable integration times found, at least {expected} expected: vary the time in the sweep"
    )]
    TooFewTimes {
        /// Number found.
        found: usize,
        /// Number that the tier needs.
        expected: usize,
    },
    /// The sweep does not determine the well.
    #[error(
        "hardly any pixel is compressed, so that the full well is not determined: extend the sweep to longer times, \
         until the brightest pixels saturate"
    )]
    NoCompression,
    /// The image is too large for a map in a calibration file.
    #[error(
        "{pixels} pixels found, at most {} expected: a map of them is too large for a calibration file",
        PixelResponse::MOST_PIXELS
    )]
    ImageTooLarge {
        /// Pixels of the image.
        pixels: usize,
    },
}

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
            Self::Intensity => Channels::INTENSITY,
            Self::PhaseSamples => Channels::PHASE_SAMPLES,
        }
    }
}

impl Response {
    /// Parameter version that this library writes.
    pub const VERSION: u32 = 1;

    /// The fitted tiers that are valid for any scene, the best first.
    pub fn tiers(&self) -> impl Iterator<Item = ResponseTier> {
        let tiers = [
            self.phase_samples.as_ref().map(|_| ResponseTier::PhaseSamples),
            self.intensity.as_ref().map(|_| ResponseTier::Intensity),
            self.amplitude.as_ref().map(|_| ResponseTier::Amplitude),
            self.scalar.as_ref().map(|_| ResponseTier::Scalar),
        ];
        tiers.into_iter().flatten()
    }

    /// Refuses parameters that no fit gives.
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
        here.optional(&self.intensity)?;
        here.optional(&self.phase_samples)
    }
}
