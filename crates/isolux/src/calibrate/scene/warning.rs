//! Warnings about ordinary recordings and their fit.

use std::fmt;

use super::MotionRefusal;
use crate::advice::Advice;
use crate::calibrate::exposure::MissingTier;
use crate::calibrate::factor_terms::FactorWarning;
use crate::calibrate::joint::JointError;
use crate::calibrate::severity::Severity;
use crate::terms::lut::LutError;

/// A warning about scenes, with its numbers.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum SceneWarning {
    /// A scene that was left out, because its motion could not be estimated.
    MotionRefused {
        /// The recording.
        recording: String,
        /// Why.
        reason: MotionRefusal,
    },
    /// A scene in which no surface was seen twice.
    Useless {
        /// The recording.
        recording: String,
    },
    /// Scenes from which nothing could be fitted.
    NothingFitted {
        /// Why.
        reason: JointError,
    },
    /// A scene in which neither camera nor integration time changes.
    NothingVaries,
    /// A scene in which the camera stands still, at integration times that are not recorded.
    StillAtUnknownTimes,
    /// No table could be fitted to the scenes' integration times.
    NoTable {
        /// Why.
        reason: LutError,
    },
    /// A tier of the response that is not fitted.
    NoTier(MissingTier),
    /// A term that scenes determine, but that was already fitted to sweeps or targets.
    TermKept {
        /// The term.
        term: &'static str,
    },
    /// A factor that becomes no term.
    Factor(FactorWarning),
}

impl SceneWarning {
    /// How much it weighs.
    #[must_use]
    pub fn severity(&self) -> Severity {
        match self {
            // Laws are fitted without the stated times then.
            Self::Factor(FactorWarning::SharedByFrames { .. }) => Severity::Doubt,
            // What a scene does not determine is left out.
            _ => Severity::Note,
        }
    }

    /// What the user can do about it.
    #[must_use]
    pub fn advice(&self) -> Option<Advice> {
        match self {
            Self::NoTable { reason } => reason.advice(),
            Self::Factor(factor) => factor.advice(),
            Self::StillAtUnknownTimes => Some(Advice::RecordTimes),
            _ => None,
        }
    }
}

impl fmt::Display for SceneWarning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::MotionRefused { recording, reason } => write!(f, "{recording}: left out, {reason}"),
            Self::Useless { recording } => write!(
                f,
                "{recording}: left out, no surface was found in two frames: too dim, too textured, too few frames, or \
                 everything moved"
            ),
            Self::NothingFitted { reason } => write!(f, "scenes: no term, {reason}"),
            Self::NothingVaries => f.write_str(
                "scenes: no term, neither the camera nor the integration time changes: whatever the amplitudes are, it may \
                 be the surfaces' reflectivity",
            ),
            Self::StillAtUnknownTimes => f.write_str(
                "scenes: no term, the camera stands still, and the integration times are not recorded: what changes from \
                 frame to frame cannot be told from the exposure",
            ),
            Self::NoTable { reason } => write!(f, "scenes: no lut, {reason}"),
            Self::NoTier(missing) => missing.fmt(f),
            Self::TermKept { term } => {
                write!(f, "scenes: `{term}` is that of the sweeps or targets, which know more; the scenes' is dropped")
            }
            Self::Factor(factor) => write!(f, "scenes: {factor}"),
        }
    }
}
