//! What the fit of targets found, for the user to judge.

use crate::calibrate::joint::Finding;

/// What the fit of targets found.
#[derive(Clone, Debug, PartialEq)]
pub struct TargetReport {
    /// Materials: labels of recordings.
    pub surfaces: Vec<SurfaceUse>,
    /// How well the windows determine each factor of the model that the terms were taken from.
    pub findings: Vec<Finding>,
    /// Unknowns of that model, without the brightness of each material.
    pub unknowns: usize,
    /// Rank of the reduced normal matrix, columns of unit length, eigenvalues above 1e-9 of the largest. Constants, r²
    /// and r⁴ are expected to be missing: the surfaces' levels and the profile's tensor hold them.
    pub rank: usize,
    /// Robust standard deviation of a window, in ln.
    pub sigma: f64,
    /// True when the angle's exponent was fixed at Lambert's 1, because the windows do not determine it.
    pub lambert_assumed: bool,
}

/// One material.
#[derive(Clone, Debug, PartialEq)]
pub struct SurfaceUse {
    /// The recording.
    pub recording: String,
    /// Its label there.
    pub label: u8,
    /// Windows that were measured.
    pub windows: usize,
    /// Windows without a weight: outliers to the others, or left out with their material.
    pub outliers: usize,
    /// Exponent of the cosine of this material alone, where its windows determine it.
    pub exponent: Option<f64>,
    /// True when it was left out because of its gloss.
    pub left_out: bool,
}
