//! Distance sweeps: a flat target at several distances. They tell the cubic and the spline over distance.

mod centre;
mod decay;
mod fit;
mod sweep;
mod warning;

pub(super) use fit::{DistanceFit, fit};
pub use sweep::{DistanceSweep, ReferenceDecays};
pub use warning::DistanceWarning;
