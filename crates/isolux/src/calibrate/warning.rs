//! What the user should know about a fit, or record better: the warnings of all kinds of recordings.

use std::fmt;

use super::distance::DistanceWarning;
use super::exposure::ExposureWarning;
use super::residual::TermResidual;
use super::scene::SceneWarning;
use super::severity::Severity;
use super::target::TargetWarning;
use crate::advice::Advice;

/// One finding about a recording or a fit, with its numbers.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum FitWarning {
    /// About exposure sweeps, the lookup table and the response.
    Exposure(ExposureWarning),
    /// About distance sweeps, the cubic and their spline.
    Distance(DistanceWarning),
    /// About labelled targets.
    Target(TargetWarning),
    /// About scenes.
    Scene(SceneWarning),
    /// A term fits its measurements badly.
    Residual(TermResidual),
}

impl FitWarning {
    /// How much it weighs.
    #[must_use]
    pub fn severity(&self) -> Severity {
        match self {
            Self::Exposure(warning) => warning.severity(),
            Self::Distance(warning) => warning.severity(),
            Self::Target(warning) => warning.severity(),
            Self::Scene(warning) => warning.severity(),
            Self::Residual(found) => found.severity(),
        }
    }

    /// What the user can do about it.
    #[must_use]
    pub fn advice(&self) -> Option<Advice> {
        match self {
            Self::Exposure(warning) => warning.advice(),
            Self::Distance(warning) => warning.advice(),
            Self::Target(warning) => warning.advice(),
            Self::Scene(warning) => warning.advice(),
            Self::Residual(_) => None,
        }
    }
}

impl fmt::Display for FitWarning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Exposure(warning) => warning.fmt(f),
            Self::Distance(warning) => warning.fmt(f),
            Self::Target(warning) => warning.fmt(f),
            Self::Scene(warning) => warning.fmt(f),
            Self::Residual(found) => found.fmt(f),
        }
    }
}
