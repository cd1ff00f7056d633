//! Warnings about recordings of targets and their fit.

use std::fmt;

use crate::advice::Advice;
use crate::calibrate::factor_terms::FactorWarning;

/// A warning about recordings of targets, with its numbers.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum TargetWarning {
    /// A recording without a window that can be measured.
    NoWindows {
        /// The recording.
        recording: String,
    },
    /// A recording without intrinsics.
    NoIntrinsics {
        /// The recording.
        recording: String,
    },
    /// A recording whose distances give no planes.
    FewNormals {
        /// The recording.
        recording: String,
        /// Windows without an angle.
        windows: usize,
        /// All its windows.
        of: usize,
    },
    /// A material left out because of its gloss.
    Glossy {
        /// The recording.
        recording: String,
        /// Its label.
        label: u8,
        /// Exponent of its cosine.
        exponent: f64,
    },
    /// The other factors were fitted with Lambert's cosine.
    LambertAssumed,
    /// A factor that becomes no term.
    Factor(FactorWarning),
}

impl TargetWarning {
    /// What the user can do about it.
    #[must_use]
    pub fn advice(&self) -> Option<Advice> {
        match self {
            Self::NoIntrinsics { .. } => Some(Advice::GiveIntrinsics),
            Self::Factor(factor) => factor.advice(),
            _ => None,
        }
    }
}

impl fmt::Display for TargetWarning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoWindows { recording } => write!(
                f,
                "{recording}: no window of 5×5 pixels inside a label of `target` that is measured, unsaturated and bright \
                 enough: nothing to learn from it"
            ),
            Self::NoIntrinsics { recording } => write!(
                f,
                "{recording}: no intrinsics {{fx, fy, cx, cy}}, so no angles of incidence: its windows count for no \
                 angle"
            ),
            Self::FewNormals { recording, windows, of } => write!(
                f,
                "{recording}: {windows} of {of} windows lie on no plane: their distances are too noisy or too few"
            ),
            Self::Glossy { recording, label, exponent } => write!(
                f,
                "{recording}: label {label} left out, its amplitude goes with cos^{exponent:.1}θ: a glossy material has its \
                 own angle law"
            ),
            Self::LambertAssumed => f.write_str(
                "targets: the other factors are fitted with Lambert's cosine, which was not measured: a glossy target \
                 bends them",
            ),
            Self::Factor(factor) => write!(f, "targets: {factor}"),
        }
    }
}
