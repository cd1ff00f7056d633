//! Estimates the ambient light of any recording from the noise of its amplitudes: light that is not modulated adds
//! noise, but no amplitude.

mod solve;
mod survey;

pub use solve::AmbientUnknown;
pub use survey::AmbientSurvey;
