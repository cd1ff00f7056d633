//! Why no spline could be fitted.

use crate::advice::Advice;

/// Positions that a spline needs; with fewer it would follow the noise of each.
pub(super) const LEAST_POSITIONS: usize = 8;

/// Why no spline could be fitted.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SplineError {
    /// Too few positions.
    #[error(
        "{found} positions found, at least {} expected: record the target at more distances",
        LEAST_POSITIONS
    )]
    TooFewPositions {
        /// Number found.
        found: usize,
    },
    /// The decays do not reach the reference distance.
    #[error(
        "no reference decay covers the reference distance of {reference_m} m: record there, or choose another"
    )]
    ReferenceOutside {
        /// Reference asked for, m.
        reference_m: f64,
    },
    /// The positions do not determine the law.
    #[error("the positions do not determine a law over distance: record more distances, evenly spread")]
    Undetermined,
    /// The multiplier is impossible somewhere.
    #[error("the law is impossible ({found}): record more distances, evenly spread")]
    Impossible {
        /// What is.
        found: String,
    },
}

impl SplineError {
    /// What the user can do about it.
    #[must_use]
    pub fn advice(&self) -> Option<Advice> {
        match self {
            Self::ReferenceOutside { .. } => Some(Advice::ReferenceDistance { distance_m: None }),
            _ => None,
        }
    }
}
