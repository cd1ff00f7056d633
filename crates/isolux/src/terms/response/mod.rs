//! `response`: corrects amplitudes for saturation, in up to six tiers that differ in the channel that shows the
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
//! | [`AmbientResponse`] | amplitude, distance, ambient light | compression by any light of even ambient |
//! | [`IntensityResponse`] | DC image | compression by any light |
//! | [`PhaseSampleResponse`] | the four raw bins | the same, without approximation, and that of the distance |
//!
//! A saturation-corrected (linearised) amplitude, DN, is what an ideal pixel that never saturates would deliver.
//! Times `t_ref / t`, it is what that pixel would deliver at the reference time. A pixel that saturates at the
//! reference time is therefore corrected there too: its multiplier is not 1.

mod ambient;
mod amplitude;
mod bins;
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

pub use ambient::{AmbientError, AmbientNoise, AmbientResponse, NoiseOfSample, TargetSample};
pub(crate) use ambient::{PlannedAmbient, Recovered};
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
