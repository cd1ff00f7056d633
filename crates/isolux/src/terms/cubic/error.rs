//! Why no cubic could be fitted.

use crate::advice::Advice;

/// Why no cubic could be fitted.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CubicError {
    /// Fewer than four distances.
    #[error(
        "{found} different distances found in the usable part of the sweep, at least 4 expected: \
         record the target at more distances"
    )]
    TooFewDistances {
        /// Number found.
        found: usize,
    },
    /// No decay covers the reference distance.
    #[error(
        "no reference decay covers the reference distance of {reference_m} m (the sweep has {min_m:.3} to \
         {max_m:.3} m): record there, or choose another"
    )]
    ReferenceOutside {
        /// Reference asked for, m.
        reference_m: f64,
        /// Nearest usable distance, m.
        min_m: f64,
        /// Farthest usable distance, m.
        max_m: f64,
    },
    /// The multiplier is impossible somewhere in its range: not positive, or outside 1e-12 to 1e12.
    #[error(
        "the cubic is {multiplier:.3e} at {distance_m:.3} m, a multiplier from 1e-12 to 1e12 expected: record more \
         distances, evenly spread"
    )]
    Impossible {
        /// Where, m.
        distance_m: f64,
        /// Value there.
        multiplier: f64,
    },
}

impl CubicError {
    /// What the user can do about it.
    #[must_use]
    pub fn advice(&self) -> Option<Advice> {
        match self {
            Self::ReferenceOutside { .. } => Some(Advice::ReferenceDistance { distance_m: None }),
            Self::TooFewDistances { .. } | Self::Impossible { .. } => None,
        }
    }
}
