//! Denoises the distance before it scales the amplitude.
//!
//! A step like d² carries the noise of the distance into the standardized amplitude. The rules here smooth the
//! distances (m) that scale the amplitude; the frame's own distances are not changed. Pixels without a measurement
//! are neither used nor changed. The amplitude determines the weight of a distance, but not where an edge is, so
//! that its texture is not copied into the distances. Distances must be unwrapped.
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
