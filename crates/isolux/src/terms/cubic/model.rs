//! The parameters of the cubic, and their check.

use serde::{Deserialize, Serialize};

use super::CubicError;
use crate::terms::check::{Check, ParameterError, Parameters};
use crate::terms::polynomial::evaluate;
use crate::terms::{DistanceGain, DistanceLaw, FitQuality, MULTIPLIER_LIMITS, Source};

/// Cubic multiplier over distance.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Cubic {
    /// Version of this term's parameters.
    pub version: u32,
    /// Coefficients of 1, d, d², d³ with d in metres; P(reference distance) = 1.
    pub coefficients: [f64; 4],
    /// Distances that the reference decays covered, m. Outside, the multiplier continues with the slope of d².
    pub valid_distance_m: [f64; 2],
    /// The recordings that it was fitted to.
    pub fitted_on: Vec<Source>,
    /// How well it fits.
    pub fit: FitQuality,
    /// Warnings of the fit: what the user should know or record better.
    pub warnings: Vec<String>,
}

impl Cubic {
    /// Parameter version that this library writes.
    pub const VERSION: u32 = 1;

    /// The multiplier in the form that the loop over pixels evaluates.
    #[must_use]
    pub fn distance_law(&self) -> DistanceLaw {
        DistanceGain::between(self.coefficients, self.valid_distance_m[0], self.valid_distance_m[1]).into()
    }

    /// Refuses parameters that no fit gives.
    ///
    /// # Errors
    /// [`ParameterError`] names the field.
    pub fn check(&self) -> Result<(), ParameterError> {
        self.check_at(&Check::of(Self::NAME))
    }

    /// This cubic with the recordings that it was fitted on, and what the user should know of them.
    #[must_use]
    pub(crate) fn with_origin(self, fitted_on: Vec<Source>, warnings: Vec<String>) -> Self {
        Self { fitted_on, warnings, ..self }
    }
}

impl Parameters for Cubic {
    const NAME: &'static str = "cubic";

    fn check_at(&self, here: &Check<'_>) -> Result<(), ParameterError> {
        here.version(self.version, Self::VERSION)?;
        let [min_m, max_m] = self.valid_distance_m;
        let finite = self.coefficients.iter().all(|c| c.is_finite());
        let coefficients = here.at("coefficients");
        coefficients.require(finite, "a value that is not finite", "four numbers")?;
        let ordered = 0.0 < min_m && min_m < max_m && max_m.is_finite();
        let range = format!("{min_m}..{max_m}");
        here.at("valid_distance_m").require(ordered, range, "two increasing distances in metres")?;
        let impossible = impossible_multiplier(self.coefficients, self.valid_distance_m)
            .map(|(distance_m, multiplier)| CubicError::Impossible { distance_m, multiplier }.to_string());
        let expected = "a multiplier from 1e-12 to 1e12 over its range";
        coefficients.require(impossible.is_none(), impossible.unwrap_or_default(), expected)
    }
}

/// A distance in the range (m) where the multiplier is impossible, and its value.
pub(super) fn impossible_multiplier(coefficients: [f64; 4], [min_m, max_m]: [f64; 2]) -> Option<(f64, f64)> {
    const STEPS: u32 = 256;
    let distances = (0..=STEPS).map(|step| min_m + (max_m - min_m) * f64::from(step) / f64::from(STEPS));
    distances.map(|d| (d, evaluate(coefficients, d))).find(|(_, value)| !MULTIPLIER_LIMITS.contains(value))
}
