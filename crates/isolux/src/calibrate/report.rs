//! What the fits found.

use super::FitWarning;
use super::exposure::ExposureCurve;
use super::scene::SceneReport;
use super::target::TargetReport;
use crate::terms::cubic::{Decay, DecayUse};
use crate::terms::spline::SplineUse;

/// What the fits found, so that the user can judge the calibration.
#[derive(Clone, Debug, PartialEq)]
pub struct FitReport {
    /// Exposure samples of each exposure sweep.
    pub exposure_curves: Vec<ExposureCurve>,
    /// Reference decays that were given to the cubic, and how it used each.
    pub decays: Vec<(Decay, DecayUse)>,
    /// How the spline used each of its decays; empty without a spline.
    pub spline_uses: Vec<SplineUse>,
    /// What the fit of targets found; `None` without targets.
    pub target: Option<TargetReport>,
    /// What the fit of scenes found; `None` without scenes.
    pub scene: Option<SceneReport>,
    /// Everything that the user should know or record better. The calibration's terms hold the same texts.
    pub warnings: Vec<FitWarning>,
}
