//! Why targets give no term.

use crate::calibrate::joint::JointError;
use crate::calibrate::measure_error::UnlikeShapes;

/// Why targets give no term at all.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TargetError {
    /// Recordings of unlike formats.
    #[error("target {0}: a profile holds for one format")]
    UnlikeShapes(#[from] UnlikeShapes),
    /// The joint model could not be fitted.
    #[error("targets: {0}")]
    Joint(#[from] JointError),
}
