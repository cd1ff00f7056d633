//! The fitted term: the law over distance, its sources, and their form in the calibration file.

use serde::{Deserialize, Serialize};

use super::{Harmonic, Law};
use crate::terms::check::{Check, ParameterError, Parameters};
use crate::terms::{FitQuality, Source};

/// Smooth law over distance.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(from = "SplineFile", into = "SplineFile")]
pub struct Spline {
    /// Version of this term's parameters.
    pub version: u32,
    /// The law. Its fields stand beside the others in the calibration file.
    pub law: Law,
    /// The recordings that it was fitted to.
    pub fitted_on: Vec<Source>,
    /// How well it fits.
    pub fit: FitQuality,
    /// Warnings of the fit: what the user should know or record better.
    pub warnings: Vec<String>,
}

impl Spline {
    /// Parameter version that this library writes.
    pub const VERSION: u32 = 1;

    /// [`Law::ln_response`].
    #[must_use]
    pub fn ln_response(&self, distance_m: f64) -> f64 {
        self.law.ln_response(distance_m)
    }

    /// [`Law::multiplier`].
    #[must_use]
    pub fn multiplier(&self, distance_m: f64) -> f64 {
        self.law.multiplier(distance_m)
    }

    /// This spline with the recordings that it was fitted on, and what the user should know of them.
    #[must_use]
    pub(crate) fn with_origin(self, fitted_on: Vec<Source>, warnings: Vec<String>) -> Self {
        Self { fitted_on, warnings, ..self }
    }

    /// Refuses parameters that no fit gives.
    ///
    /// # Errors
    /// [`ParameterError`] names the field.
    pub fn check(&self) -> Result<(), ParameterError> {
        self.check_at(&Check::of(Self::NAME))
    }
}

impl Parameters for Spline {
    const NAME: &'static str = "spline";

    fn check_at(&self, here: &Check<'_>) -> Result<(), ParameterError> {
        here.version(self.version, Self::VERSION)?;
        self.law.check_at(here)
    }
}

/// The term as the calibration file holds it: the law's numbers beside those of their origin. By hand, because serde
/// cannot both flatten a struct and refuse unknown fields.
#[derive(Serialize, Deserialize)]
#[serde(rename = "Spline", deny_unknown_fields)]
struct SplineFile {
    version: u32,
    reference_distance_m: f64,
    valid_distance_m: [f64; 2],
    coefficients: Vec<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    harmonic: Option<Harmonic>,
    curvature_weight: f64,
    fitted_on: Vec<Source>,
    fit: FitQuality,
    warnings: Vec<String>,
}

impl From<SplineFile> for Spline {
    fn from(file: SplineFile) -> Self {
        let law = Law {
            reference_distance_m: file.reference_distance_m,
            valid_distance_m: file.valid_distance_m,
            coefficients: file.coefficients,
            harmonic: file.harmonic,
            curvature_weight: file.curvature_weight,
        };
        let SplineFile { version, fitted_on, fit, warnings, .. } = file;
        Self { version, law, fitted_on, fit, warnings }
    }
}

impl From<Spline> for SplineFile {
    fn from(Spline { version, law, fitted_on, fit, warnings }: Spline) -> Self {
        let Law { reference_distance_m, valid_distance_m, coefficients, harmonic, curvature_weight } = law;
        Self {
            version,
            reference_distance_m,
            valid_distance_m,
            coefficients,
            harmonic,
            curvature_weight,
            fitted_on,
            fit,
            warnings,
        }
    }
}
