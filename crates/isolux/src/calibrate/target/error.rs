//! Why no term can be fitted to targets.

use crate::calibrate::joint::JointError;
use crate::calibrate::measure_error::UnlikeShapes;

/// Why no term can be fitted to targets.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TargetError {
    /// The recordings' frames differ in shape.
    #[error("target {0}: a profile holds for one format")]
    UnlikeShapes(#[from] UnlikeShapes),
    /// The joint model could not be fitted.
    #[error("targets: {0}")]
    Joint(#[from] JointError),
}
