//! Warnings about recordings of targets and their fit.

use std::fmt;

use crate::advice::Advice;
use crate::calibrate::factor_terms::FactorWarning;
use crate::calibrate::severity::Severity;

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
    /// A flat target that the intrinsics make curved.
    Curved {
        /// The recording.
        recording: String,
        /// Deviation from the plane, root mean square, m.
        deviation_m: f64,
        /// With the focal lengths times this factor, the target would be flat.
        focal_factor: f64,
    },
    /// Laws over distance and place that are not given, because no angle of incidence is known.
    NoAngles,
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
    /// How much it weighs.
    #[must_use]
    pub fn severity(&self) -> Severity {
        match self {
            Self::Curved { .. } => Severity::Poor,
            Self::Factor(factor) => factor.severity(),
            Self::Glossy { .. } => Severity::Note,
            _ => Severity::Doubt,
        }
    }

    /// What the user can do about it.
    #[must_use]
    pub fn advice(&self) -> Option<Advice> {
        match self {
            Self::NoIntrinsics { .. } | Self::NoAngles => Some(Advice::GiveIntrinsics),
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
                "{recording}: no intrinsics {{fx, fy, cx, cy}} and no rays, so no angles of incidence: its windows count for no \
                 angle"
            ),
            Self::Curved { recording, deviation_m, focal_factor } => write!(
                f,
                "{recording}: the intrinsics do not fit: the flat target appears curved, by {:.0} mm; it would be flat with \
                 focal lengths of about {focal_factor:.2} times theirs",
                1000.0 * deviation_m
            ),
            Self::NoAngles => f.write_str(
                "targets: no spline and no profile: without angles of incidence, a tilted target looks like a darker one, \
                 and both laws would be wrong by tens of per cent",
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
