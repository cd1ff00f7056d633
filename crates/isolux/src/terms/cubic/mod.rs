//! `cubic`: the paper's polynomial over distance (section 2.2): reference decays are inverted, normalized at the
//! reference distance, and pooled under one cubic.

mod decay;
mod error;
mod fit;
mod model;
#[cfg(test)]
mod tests;

pub use decay::{Decay, DecayPoint, DecayUse, Scaling};
pub use error::CubicError;
pub use model::Cubic;
