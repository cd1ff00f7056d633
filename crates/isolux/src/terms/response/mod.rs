//! `response`: what is left of the amplitude as the pixel's well fills, with up to five tiers of evidence.
//!
//! A pixel compresses by its total charge, ambient light included, not by its amplitude:
//! `A_lin = A / f′(x)`, x its linear well fill (eq. 3 of Stürmer, Penne and Hornegger 2008; methods, section 2). How
//! well x is known depends on what the camera delivers; each tier is fitted where an exposure sweep offers its
//! evidence, and each stands alone.
//!
//! | tier | evidence | takes out |
//! |---|---|---|
//! | [`ScalarResponse`] | mean of the image | what a lookup table does |
//! | [`AmplitudeResponse`] | amplitude of the pixel | compression without ambient light |
//! | [`PixelResponse`] | static scene at several times | compression of each pixel of that scene |
//! | [`IntensityResponse`] | DC image | compression by any light |
//! | [`PhaseSampleResponse`] | the four raw bins | the same, without approximation, and that of the distance |
//!
//! The gauge: a linearised amplitude is that of a pixel without a full well. Times `t_ref / t` it is what such a
//! pixel would deliver at the reference time; the multiplier of a pixel that is compressed there is not 1.

mod amplitude;
mod error;
mod fill_time;
mod full_well;
mod intensity;
mod map_rows;
mod means;
mod parameters;
mod phase_samples;
mod pixel;
mod scalar;
mod solve;
mod still;
mod tier;
mod well;
mod well_fit;

pub use amplitude::AmplitudeResponse;
pub(crate) use amplitude::PlannedAmplitude;
pub use error::ResponseError;
pub use full_well::FullWell;
pub use intensity::IntensityResponse;
pub(crate) use intensity::PlannedIntensity;
pub(crate) use means::{AmplitudeStack, PixelMeans, PixelSeries};
pub use parameters::Response;
pub use phase_samples::PhaseSampleResponse;
pub(crate) use phase_samples::PlannedBins;
pub use pixel::PixelResponse;
pub(crate) use pixel::PlannedPixels;
pub use scalar::ScalarResponse;
pub use tier::ResponseTier;
pub use well::SoftWell;
