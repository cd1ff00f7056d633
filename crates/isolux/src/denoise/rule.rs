//! The rules and their names.

use super::temporal::TemporalMean;
use super::{facet, median, wiener};
use crate::names::named;

named! {
    /// How the distance is denoised.
    #[non_exhaustive]
    pub enum DenoiseRule: "denoising rule" {
        /// Median of the valid distances of 3×3 pixels.
        Median = "median",
        /// Variance-weighted local Wiener filter of 5×5 pixels: the fast one.
        Wiener = "wiener",
        /// Plane fits in 7×7 pixels: for slanted surfaces and quality.
        Plane = "plane",
        /// Mean of the last 8 frames, for still scenes.
        Temporal = "temporal",
    }
}

impl DenoiseRule {
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
