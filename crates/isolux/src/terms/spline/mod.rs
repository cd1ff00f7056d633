//! `spline`: a smooth law over distance around the inverse square, in logarithms (beyond the paper):
//! `ln h(d) = −2 ln(d/d_ref) + Σ c_k B_k(ln d) + w_c cos 4φ + w_s sin 4φ`, `φ = 4π f d / c`.
//!
//! The B-splines take up what a light source of finite size adds to the inverse square (or what a vendor has taken
//! from it); the harmonic is the aliased third one of the modulation (`A (1 + h₃ cos 4φ)`), known once the
//! modulation frequency is. Outside the fitted distances h goes on with the slope −2.

mod fit;
mod rows;
mod select;
#[cfg(test)]
mod tests;

use std::f64::consts::PI;

use serde::{Deserialize, Serialize};

pub use fit::{SplineError, SplineUse};

use super::table::DistanceTable;
use super::{DistanceGain, DistanceLaw, FitQuality, MULTIPLIER_LIMITS, ParameterError, Source, require};
use crate::frame::phase::SPEED_OF_LIGHT_M_PER_S;
use crate::numerics::bspline::Basis;

/// Smooth law over distance.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Spline {
    /// Version of this term's parameters.
    pub version: u32,
    /// Radial distance at which h = 1, m: that of the calibration.
    pub reference_distance_m: f64,
    /// Distances that the reference decays covered, m. Outside, h goes on with the slope of d⁻².
    pub valid_distance_m: [f64; 2],
    /// Coefficients of the cubic B-splines on equal intervals of ln d between the valid distances: three more than
    /// intervals, dimensionless.
    pub coefficients: Vec<f64>,
    /// The aliased harmonic; absent where the modulation frequency is unknown or the decays do not show it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub harmonic: Option<Harmonic>,
    /// Weight of the curvature `∫ s″² d(ln d)` against the mean squared residual, chosen by cross-validation.
    pub curvature_weight: f64,
    /// What it was fitted on.
    pub fitted_on: Vec<Source>,
    /// How well it fits.
    pub fit: FitQuality,
    /// What the user should know or record better.
    pub warnings: Vec<String>,
}

/// The aliased third harmonic of the modulation, in ln h.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Harmonic {
    /// Modulation frequency f, Hz.
    pub modulation_frequency_hz: f64,
    /// Coefficient w_c of cos 4φ, dimensionless.
    pub cosine: f64,
    /// Coefficient w_s of sin 4φ, dimensionless.
    pub sine: f64,
}

impl Harmonic {
    /// 4φ at a distance (m), not wrapped, rad.
    fn angle(modulation_frequency_hz: f64, distance_m: f64) -> f64 {
        16.0 * PI * modulation_frequency_hz * distance_m / SPEED_OF_LIGHT_M_PER_S
    }

    /// `[cos 4φ, sin 4φ]`.
    pub(crate) fn columns(modulation_frequency_hz: f64, distance_m: f64) -> [f64; 2] {
        let (sine, cosine) = Self::angle(modulation_frequency_hz, distance_m).sin_cos();
        [cosine, sine]
    }

    /// Its part of ln h at a distance (m).
    pub(crate) fn at(&self, distance_m: f64) -> f64 {
        let [cosine, sine] = Self::columns(self.modulation_frequency_hz, distance_m);
        self.cosine * cosine + self.sine * sine
    }
}

impl Spline {
    /// Parameter version that this library writes.
    pub const VERSION: u32 = 1;
    /// Limit of 4φ at the far end, rad: forty ambiguity ranges, and what the table of the hot loop resolves.
    const LARGEST_ANGLE: f64 = 1000.0;
    /// Limits of the number of coefficients.
    const COEFFICIENTS: std::ops::RangeInclusive<usize> = 4..=256;

    /// ln h at a distance (m): 0 at the reference distance.
    #[must_use]
    pub fn ln_response(&self, distance_m: f64) -> f64 {
        self.deviation(distance_m) - 2.0 * (distance_m / self.reference_distance_m).ln()
    }

    /// The multiplier 1/h at a distance (m): 1 at the reference distance.
    #[must_use]
    pub fn multiplier(&self, distance_m: f64) -> f64 {
        (-self.ln_response(distance_m)).exp()
    }

    /// The multiplier in the form that the hot loop evaluates: `(d/d_ref)²` at every distance, whose range flags
    /// what is extrapolated, times the table of `exp(−deviation)`, which stays as it is outside the range.
    #[must_use]
    pub fn distance_law(&self) -> DistanceLaw {
        let [min_m, max_m] = self.valid_distance_m;
        let square = [0.0, 0.0, self.reference_distance_m.powi(-2), 0.0];
        let table = DistanceTable::new(|d| (-self.smooth_deviation(d)).exp(), min_m, max_m);
        DistanceLaw { polynomial: DistanceGain::between(square, min_m, max_m), table: Some(table) }
    }

    /// What ln h has besides the inverse square; outside the valid distances, its value at the nearer end.
    fn deviation(&self, distance_m: f64) -> f64 {
        let [min_m, max_m] = self.valid_distance_m;
        self.smooth_deviation(distance_m.max(min_m).min(max_m))
    }

    /// The same without the kink at either end, which no table could follow.
    fn smooth_deviation(&self, distance_m: f64) -> f64 {
        let harmonic = self.harmonic.map_or(0.0, |harmonic| harmonic.at(distance_m));
        self.basis().sum(&self.coefficients, distance_m.ln()) + harmonic
    }

    fn basis(&self) -> Basis {
        let [min_m, max_m] = self.valid_distance_m;
        Basis::new(min_m.ln(), max_m.ln(), self.coefficients.len().saturating_sub(3).max(1))
    }

    /// Refuses parameters that no fit can have written.
    ///
    /// # Errors
    /// [`ParameterError`] names the field.
    pub fn check(&self) -> Result<(), ParameterError> {
        let [min_m, max_m] = self.valid_distance_m;
        require(self.version == Self::VERSION, "spline.version", self.version, "1")?;
        // As far as the tables of the hot loop reach.
        let ordered = 1e-4 <= min_m && min_m < max_m && max_m <= 1e5;
        let range = format!("{min_m}..{max_m}");
        require(
            ordered,
            "spline.valid_distance_m",
            range,
            "two increasing distances in metres, 1e-4 to 1e5",
        )?;
        let reference_m = self.reference_distance_m;
        let covered = min_m <= reference_m && reference_m <= max_m;
        require(covered, "spline.reference_distance_m", reference_m, "a distance in the valid range")?;
        let count = self.coefficients.len();
        let fine = Self::COEFFICIENTS.contains(&count) && self.coefficients.iter().all(|c| c.is_finite());
        let found = format!("{count} coefficients, or one that is not finite");
        require(fine, "spline.coefficients", found, "4 to 256 numbers")?;
        if let Some(Harmonic { modulation_frequency_hz, cosine, sine }) = self.harmonic {
            let angle = Harmonic::angle(modulation_frequency_hz, max_m);
            let fine = modulation_frequency_hz > 0.0 && angle <= Self::LARGEST_ANGLE;
            let expected = "a positive frequency with at most 40 ambiguity ranges in the valid distances";
            require(fine, "spline.harmonic.modulation_frequency_hz", modulation_frequency_hz, expected)?;
            let largest = cosine.abs().max(sine.abs());
            let fine = cosine.abs() <= Self::LARGEST_HARMONIC && sine.abs() <= Self::LARGEST_HARMONIC;
            require(fine, "spline.harmonic", largest, "coefficients from -0.5 to 0.5")?;
        }
        let impossible = self.impossible().map_or_else(String::new, |(d, h)| format!("{h:.3e} at {d:.3} m"));
        let expected = "a multiplier from 1e-12 to 1e12 over its range";
        require(impossible.is_empty(), "spline.coefficients", impossible, expected)?;
        let weight = self.curvature_weight;
        require(weight >= 0.0 && weight.is_finite(), "spline.curvature_weight", weight, "0 or more")
    }

    /// Largest coefficient of the harmonic: half of the light would be one.
    const LARGEST_HARMONIC: f64 = 0.5;

    /// A distance in the valid range where the multiplier is beyond all reason, and its value.
    fn impossible(&self) -> Option<(f64, f64)> {
        const STEPS: u32 = 512;
        let [min_m, max_m] = self.valid_distance_m;
        let distances = (0..=STEPS).map(|i| min_m * (max_m / min_m).powf(f64::from(i) / f64::from(STEPS)));
        distances.map(|d| (d, self.multiplier(d))).find(|(_, m)| !MULTIPLIER_LIMITS.contains(m))
    }
}
