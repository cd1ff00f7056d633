//! Less noise in the distance before it scales the amplitude.
//!
//! A step like d² carries the distance's noise into the standardized amplitude. The rules here smooth the distance
//! that scales, and nothing else: a frame's own distance stays as it is. Pixels without a measurement neither give
//! nor take; the amplitude decides how much a distance is trusted, never where an edge is, so that its texture is
//! not copied. Distances must be unwrapped.
//!
//! | rule | window | what it is for |
//! |---|---|---|
//! | [`DenoiseRule::Median`] | 3×3 | needs no noise model |
//! | [`DenoiseRule::Wiener`] | 5×5 | real time |
//! | [`DenoiseRule::Plane`] | 7×7 | quality, slanted surfaces |
//! | [`DenoiseRule::Temporal`] | 8 frames | still scenes; see [`TemporalMean`] |

mod denoiser;
mod error;
mod facet;
mod image;
mod median;
mod noise;
mod rule;
mod temporal;
#[cfg(test)]
mod tests;
mod wiener;

pub(crate) use denoiser::Denoiser;
pub use error::DenoiseError;
pub use rule::DenoiseRule;
pub use temporal::TemporalMean;
