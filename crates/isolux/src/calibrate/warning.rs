//! What the user should know about a fit, or record better: the warnings of all kinds of recordings.

use std::fmt;

use super::distance::DistanceWarning;
use super::exposure::ExposureWarning;
use super::scene::SceneWarning;
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
}

impl FitWarning {
    /// What the user can do about it.
    #[must_use]
    pub fn advice(&self) -> Option<Advice> {
        match self {
            Self::Exposure(warning) => warning.advice(),
            Self::Distance(warning) => warning.advice(),
            Self::Target(warning) => warning.advice(),
            Self::Scene(warning) => warning.advice(),
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
        }
    }
}
