//! Distance sweeps: recordings of a flat target at several distances, to which cubic and spline are fitted.

mod ambient;
mod background;
mod centre;
mod decay;
mod faults;
mod fit;
mod repeats;
mod step;
mod stray;
mod sweep;
mod warning;
mod wrap;

pub(super) use fit::{DistanceFit, fit};
pub use sweep::{DistanceSweep, ReferenceDecays};
pub use warning::DistanceWarning;
