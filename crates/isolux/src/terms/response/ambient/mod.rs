//! Tier T1c, `ambient`: distance and place show how full the well is, because ambient light and the camera's own are
//! reflected alike.
//!
//! A surface returns both with one reflectivity. Their ratio does not depend on it, but on the distance alone: where a
//! surface returns the linear amplitude a, the mean of its bins holds the charge `a c`,
//! `c = c0 + B / (K h(d))`. c0 is the charge of the camera's own light per amplitude (the inverse of the modulation
//! contrast), K h(d) the amplitude per µs of the target of the calibration, h the law over distance, and B the charge
//! per µs that the ambient light puts into a pixel that sees this target. Four numbers of the camera (W, p, c0, K) and
//! one of the scene (B) then tell the fill of each pixel from amplitude and distance. B of another scene follows from
//! the noise of its amplitudes, [`AmbientSurvey`](crate::calibrate::AmbientSurvey).
//!
//! Amplitudes determine W/c0 only, not W and c0 each: a prior on c0 fixes this gauge, which no correction depends on.

mod error;
mod fit;
mod light;
mod model;
mod planned;
mod sample;

#[cfg(test)]
mod tests;

pub use error::AmbientError;
pub use model::{AmbientNoise, AmbientResponse};
pub(crate) use planned::{PlannedAmbient, Recovered};
pub use sample::{NoiseOfSample, TargetSample};
