//! What the fit of scenes found, for the user to judge.

use super::{MotionFinding, SceneObservations};
use crate::calibrate::joint::Finding;

/// What the fit of scenes found.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneReport {
    /// The recordings.
    pub scenes: Vec<SceneUse>,
    /// Observations of surfaces that were seen more than once.
    pub observations: usize,
    /// Those surfaces, each of a reflectivity of its own.
    pub surfaces: usize,
    /// Share of the observations that contradict the others and do not count, 0..=1.
    pub outlier_share: f64,
    /// Robust standard deviation of an ordinary observation, in ln.
    pub sigma: f64,
    /// Unknowns beside the surfaces' reflectivities.
    pub unknowns: usize,
    /// Rank of the reduced normal matrix, columns of unit length, eigenvalues above 1e-9 of the largest. Constants, r²
    /// and r⁴ are expected to be missing: the surfaces' levels and the profile's tensor hold them.
    pub rank: usize,
    /// Root mean square of the relative error on frames that were left out.
    pub held_out_residual: Option<f64>,
    /// How well the observations determine each factor.
    pub findings: Vec<Finding>,
}

/// One recording.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneUse {
    /// The recording.
    pub recording: String,
    /// How the camera moved, or why that could not be estimated.
    pub motion: MotionFinding,
    /// Observations that it gave.
    pub observations: usize,
}

impl SceneUse {
    pub(super) fn of(scene: &SceneObservations) -> Self {
        Self {
            recording: scene.source.recording.clone(),
            motion: scene.motion,
            observations: scene.observations.len(),
        }
    }
}

impl SceneReport {
    /// The report where nothing could be fitted.
    pub(super) fn nothing(scenes: &[SceneObservations]) -> Self {
        Self {
            scenes: scenes.iter().map(SceneUse::of).collect(),
            observations: 0,
            surfaces: 0,
            outlier_share: 0.0,
            sigma: 0.0,
            unknowns: 0,
            rank: 0,
            held_out_residual: None,
            findings: Vec::new(),
        }
    }
}
