//! Recordings of labelled targets in any pose, to which the spline, the profile and the exponent of the cosine are
//! fitted. They are measured by medians over small windows inside a label, frame by frame. A row of pixels at the
//! label's border that see two materials hardly changes a median.

mod error;
mod fit;
mod flat;
mod flatness;
mod gloss;
mod joint_input;
mod measure;
mod noise;
mod patches;
mod report;
mod sweep;
#[cfg(test)]
mod tests;
mod warning;

pub use error::TargetError;
pub(super) use fit::fit;
pub use report::{SurfaceUse, TargetReport};
pub use sweep::{TargetSweep, TargetWindows, label_windows};
pub use warning::TargetWarning;
