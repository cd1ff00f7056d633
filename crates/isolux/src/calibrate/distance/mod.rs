//! Distance sweeps: recordings of a flat target at several distances, to which cubic and spline are fitted.

mod ambient;
mod centre;
mod decay;
mod fit;
mod repeats;
mod sweep;
mod warning;

pub(super) use fit::{DistanceFit, fit};
pub use sweep::{DistanceSweep, ReferenceDecays};
pub use warning::DistanceWarning;
