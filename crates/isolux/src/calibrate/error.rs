//! Why a calibration fails.

use super::{FitWarning, joint};
use crate::frame::ShapeError;
use crate::standardize::StandardizeError;
use crate::terms::cubic::CubicError;
use crate::terms::lut::LutError;

/// Why a recording cannot serve as a sweep, or a term cannot be fitted.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CalibrateError {
    /// Frames without a single integration time in an exposure sweep.
    #[error(
        "frame {frame}: integration time is {found}, one known time for the whole frame expected: \
             an exposure sweep varies the time from frame to frame"
    )]
    NoSingleTime {
        /// Frame number, from 0.
        frame: usize,
        /// What is there.
        found: &'static str,
    },
    /// A distance sweep without distances.
    #[error(
        "frame {frame}: no distance channel found, one expected: a distance sweep is measured against it"
    )]
    NoDistance {
        /// Frame number, from 0.
        frame: usize,
    },
    /// A frame without a pose where poses are said to be recorded.
    #[error("frame {frame}: no pose (`world_from_camera`) found, one for every frame expected")]
    NoPose {
        /// Frame number, from 0.
        frame: usize,
    },
    /// A pose that is not rigid.
    #[error(
        "frame {frame}: `world_from_camera` is no rigid transform: a rotation (orthonormal, no mirror), a translation \
         in metres and a last row of 0 0 0 1 expected"
    )]
    NotRigid {
        /// Frame number, from 0.
        frame: usize,
    },
    /// A frame whose planes do not fit together.
    #[error("frame {frame}: {source}")]
    Shape {
        /// Frame number, from 0.
        frame: usize,
        /// The plane.
        source: ShapeError,
    },
    /// A target's recording without labels.
    #[error(
        "frame {frame}: no target channel found, one expected: its labels say which pixels are one material"
    )]
    NoTarget {
        /// Frame number, from 0.
        frame: usize,
    },
    /// Targets' recordings of unlike formats.
    #[error(
        "target {recording}: images of {found} found, {expected} expected: a profile holds for one format"
    )]
    TargetShape {
        /// The recording.
        recording: String,
        /// Its shape.
        found: String,
        /// That of the first.
        expected: String,
    },
    /// A camera that moves, without intrinsics.
    #[error(
        "no intrinsics {{fx, fy, cx, cy}} in recording.json, expected: a camera that moves sees its surfaces through them"
    )]
    NoIntrinsics,
    /// Scenes of unlike formats.
    #[error("scene {recording}: images of {found} found, {expected} expected: one camera, one format")]
    SceneShape {
        /// The recording.
        recording: String,
        /// Its shape.
        found: String,
        /// That of the first.
        expected: String,
    },
    /// The joint model could not be fitted.
    #[error("targets: {0}")]
    Target(joint::JointError),
    /// A frame that the response cannot make linear.
    #[error("linear amplitude: {0}")]
    Linear(#[from] StandardizeError),
    /// No sweep given.
    #[error(
        "no recording given: calibrate needs at least one exposure sweep, distance sweep, target or scene"
    )]
    NothingToFit,
    /// The table could not be fitted.
    #[error("exposure sweep {recording}: {source}")]
    Lut {
        /// The recording.
        recording: String,
        /// Why.
        source: LutError,
        /// What was left out before, and why.
        warnings: Vec<FitWarning>,
    },
    /// The cubic could not be fitted.
    #[error("distance sweep: {source}")]
    Cubic {
        /// Why.
        source: CubicError,
        /// What was left out before, and why.
        warnings: Vec<FitWarning>,
    },
}

impl CalibrateError {
    /// What was left out before the fit failed: often the reason.
    #[must_use]
    pub fn warnings(&self) -> &[FitWarning] {
        match self {
            Self::Lut { warnings, .. } | Self::Cubic { warnings, .. } => warnings,
            _ => &[],
        }
    }
}
