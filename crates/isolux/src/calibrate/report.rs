//! What the fits found, for the user to judge.

use super::FitWarning;
use super::exposure::ExposureCurve;
use super::scene::SceneReport;
use super::target::TargetReport;
use crate::terms::cubic::{Decay, DecayUse};
use crate::terms::spline::SplineUse;

/// What the fits found, for the user to judge them.
#[derive(Clone, Debug, PartialEq)]
pub struct FitReport {
    /// Exposure samples of each exposure sweep.
    pub exposure_curves: Vec<ExposureCurve>,
    /// Reference decays as they entered the cubic, with what became of them.
    pub decays: Vec<(Decay, DecayUse)>,
    /// What became of the decays that the spline was fitted on; empty where there is none.
    pub spline_uses: Vec<SplineUse>,
    /// What the fit of targets found.
    pub target: Option<TargetReport>,
    /// What the fit of scenes found.
    pub scene: Option<SceneReport>,
    /// Everything that the user should know or record better, also in the calibration's terms.
    pub warnings: Vec<FitWarning>,
}
