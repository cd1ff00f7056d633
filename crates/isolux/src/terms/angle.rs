//! `angle`: the share `cos^k θ` of the light that remains at an angle of incidence θ (beyond the paper); k = 1 is
//! Lambert's law, the textbook step without a calibration.
//!
//! The cosines come from planes fitted to the denoised distances. They are clamped at [`LEAST_COSINE`], because
//! below it the errors of the distances would be multiplied without limit. Clamped pixels are flagged.

use serde::{Deserialize, Serialize};

use super::check::{Check, ParameterError, Parameters};
use super::{FitQuality, Source};

/// Least cosine that is corrected for: 78°.
pub const LEAST_COSINE: f64 = 0.2;
/// Lambert's exponent.
pub const LAMBERT: f64 = 1.0;

/// The exponent of the cosine of incidence, common to the materials that it was fitted on.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Angle {
    /// Version of this term's parameters.
    pub version: u32,
    /// k, dimensionless.
    pub exponent: f64,
    /// Its predicted standard error.
    pub standard_error: f64,
    /// Least and greatest cosine of the fit. Below, pixels are extrapolated, down to 0.2, and flagged.
    pub valid_cosine: [f64; 2],
    /// The recordings that it was fitted to.
    pub fitted_on: Vec<Source>,
    /// How well all factors together fit the observations.
    pub fit: FitQuality,
    /// Warnings of the fit: what the user should know or record better.
    pub warnings: Vec<String>,
}

impl Angle {
    /// Parameter version that this library writes.
    pub const VERSION: u32 = 1;
    /// Beyond 16, a surface is a mirror, which cannot be corrected.
    const LARGEST_EXPONENT: f64 = 16.0;

    /// Refuses parameters that no fit gives.
    ///
    /// # Errors
    /// [`ParameterError`] names the field.
    pub fn check(&self) -> Result<(), ParameterError> {
        self.check_at(&Check::of(Self::NAME))
    }
}

impl Parameters for Angle {
    const NAME: &'static str = "angle";

    fn check_at(&self, here: &Check<'_>) -> Result<(), ParameterError> {
        here.version(self.version, Self::VERSION)?;
        let fine = self.exponent.abs() <= Self::LARGEST_EXPONENT;
        here.at("exponent").require(fine, self.exponent, "a number from -16 to 16")?;
        let error = self.standard_error;
        here.at("standard_error").require(error >= 0.0 && error.is_finite(), error, "0 or more")?;
        let [least, greatest] = self.valid_cosine;
        let fine = 0.0 < least && least < greatest && greatest <= 1.0;
        let (found, expected) =
            (format!("{least}..{greatest}"), "two increasing cosines, above 0 and at most 1");
        here.at("valid_cosine").require(fine, found, expected)
    }
}

/// The multiplier `cos^−k θ` at a cosine, clamped at [`LEAST_COSINE`]; NaN stays NaN.
#[must_use]
pub fn multiplier(exponent: f64, cosine: f64) -> f64 {
    // `clamp` keeps NaN, `max` would not.
    cosine.clamp(LEAST_COSINE, 1.0).powf(-exponent)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn angle() -> Angle {
        Angle {
            version: 1,
            exponent: 1.8,
            standard_error: 0.02,
            valid_cosine: [0.5, 1.0],
            fitted_on: Vec::new(),
            fit: FitQuality { points: 100, residual: 0.02, held_out_residual: None },
            warnings: Vec::new(),
        }
    }

    #[test]
    fn the_multiplier_is_clamped_and_keeps_what_is_unknown() {
        assert_eq!(multiplier(LAMBERT, 0.5), 2.0);
        assert_eq!(multiplier(LAMBERT, 0.01), 5.0);
        assert_eq!(multiplier(2.0, 1.0), 1.0);
        assert!(multiplier(LAMBERT, f64::NAN).is_nan());
    }

    #[test]
    fn edited_parameters_are_checked() {
        assert!(angle().check().is_ok());
        let spoil = |change: fn(&mut Angle)| {
            let mut angle = angle();
            change(&mut angle);
            angle.check().unwrap_err().field
        };
        assert_eq!(spoil(|a| a.version = 0), "angle.version");
        assert_eq!(spoil(|a| a.exponent = f64::NAN), "angle.exponent");
        assert_eq!(spoil(|a| a.standard_error = -1.0), "angle.standard_error");
        assert_eq!(spoil(|a| a.valid_cosine = [0.9, 0.9]), "angle.valid_cosine");
        assert_eq!(spoil(|a| a.valid_cosine[0] = f64::NAN), "angle.valid_cosine");
    }
}
