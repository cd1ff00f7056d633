//! Why a calibration fails.

use super::FitWarning;
use super::measure_error::UnlikeShapes;
use super::target::TargetError;
use crate::advice::Advice;
use crate::terms::cubic::CubicError;
use crate::terms::lut::LutError;

/// Why a term cannot be fitted from measured recordings.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CalibrateError {
    /// No recording is given.
    #[error(
        "no recording given: at least one exposure sweep, distance sweep, target or scene expected, which is what \
         terms are fitted to"
    )]
    NothingToFit,
    /// The lookup table could not be fitted.
    #[error("exposure sweep {recording}: {source}")]
    Lut {
        /// The recording.
        recording: String,
        /// Why.
        source: LutError,
        /// What was left out before the fit failed, and why.
        warnings: Vec<FitWarning>,
    },
    /// The cubic could not be fitted.
    #[error("distance sweep: {source}")]
    Cubic {
        /// Why.
        source: CubicError,
        /// What was left out before the fit failed, and why.
        warnings: Vec<FitWarning>,
    },
    /// No term could be fitted to the targets.
    #[error(transparent)]
    Target(#[from] TargetError),
    /// The scenes' frames differ in shape.
    #[error("scene {0}: one camera, one format")]
    SceneShapes(UnlikeShapes),
}

impl CalibrateError {
    /// What was left out before the fit failed, which is often the reason.
    #[must_use]
    pub fn warnings(&self) -> &[FitWarning] {
        match self {
            Self::Lut { warnings, .. } | Self::Cubic { warnings, .. } => warnings,
            _ => &[],
        }
    }

    /// What the user can do about it.
    #[must_use]
    pub fn advice(&self) -> Option<Advice> {
        match self {
            Self::Lut { source, .. } => source.advice(),
            Self::Cubic { source, .. } => source.advice(),
            _ => None,
        }
    }
}
