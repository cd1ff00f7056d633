//! The rules and what they are called.

use super::temporal::TemporalMean;
use super::{facet, median, wiener};

/// How the distance is denoised.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum DenoiseRule {
    /// Median of the valid distances of 3×3 pixels.
    Median,
    /// Variance-weighted local Wiener filter of 5×5 pixels.
    Wiener,
    /// Plane fits in 7×7 pixels to the surface of the middle one.
    Plane,
    /// Mean of the last frames of a still scene.
    Temporal,
}

impl DenoiseRule {
    /// Name on the command line and in recordings.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Median => "median",
            Self::Wiener => "wiener",
            Self::Plane => "plane",
            Self::Temporal => "temporal",
        }
    }

    /// The rule's parameters in words, for the record of applied steps.
    #[must_use]
    pub fn parameters(self) -> String {
        let window = |radius: usize| format!("{0}×{0} pixels", 2 * radius + 1);
        match self {
            Self::Median => window(median::RADIUS),
            Self::Wiener => format!("{}, σ ∝ 1/amplitude estimated per frame", window(wiener::RADIUS)),
            Self::Plane => format!("{}, σ ∝ 1/amplitude estimated per frame", window(facet::RADIUS)),
            Self::Temporal => format!("last {} frames, weighted by amplitude²", TemporalMean::FRAMES),
        }
    }
}
