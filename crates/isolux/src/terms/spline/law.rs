//! The law over distance: its coefficients, its value at a distance, and the check.

use serde::{Deserialize, Serialize};

use super::Harmonic;
use crate::numerics::bspline::Basis;
use crate::terms::check::{Check, ParameterError};
use crate::terms::{DistanceGain, DistanceLaw, DistanceTable, MULTIPLIER_LIMITS};

/// A law over distance: `ln h = −2 ln(d/d_ref) + Σ c_k B_k(ln d) + harmonic`, slope −2 outside.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Law {
    /// Radial distance at which h = 1, m: that of the calibration.
    pub reference_distance_m: f64,
    /// Distances that were observed, m. Outside, h continues with the slope of d⁻².
    pub valid_distance_m: [f64; 2],
    /// Coefficients of the cubic B-splines on equal intervals of ln d between the valid distances: three more than
    /// intervals, dimensionless.
    pub coefficients: Vec<f64>,
    /// The aliased harmonic; absent where the modulation frequency is unknown or the decays do not show it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub harmonic: Option<Harmonic>,
    /// Weight of the curvature `∫ s″² d(ln d)` against the mean squared residual.
    pub curvature_weight: f64,
}

impl Law {
    /// Limit of 4φ at the far end, rad: forty ambiguity ranges, and what the table of the hot loop resolves.
    const LARGEST_ANGLE: f64 = 1000.0;
    /// Limits of the number of coefficients.
    const COEFFICIENTS: std::ops::RangeInclusive<usize> = 4..=256;
    /// Largest coefficient of the harmonic: half of the light would be one.
    const LARGEST_HARMONIC: f64 = 0.5;

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

    /// The multiplier in the form that the loop over pixels evaluates: `(d/d_ref)²` at every distance, whose range
    /// decides which pixels are flagged as extrapolated, times a table of `exp(−deviation)`, which is constant
    /// outside the range.
    #[must_use]
    pub fn distance_law(&self) -> DistanceLaw {
        let [min_m, max_m] = self.valid_distance_m;
        let square = [0.0, 0.0, self.reference_distance_m.powi(-2), 0.0];
        let table = DistanceTable::new(|d| (-self.smooth_deviation(d)).exp(), min_m, max_m);
        DistanceLaw { polynomial: DistanceGain::between(square, min_m, max_m), table: Some(table) }
    }

    /// Deviation of ln h from the inverse square; outside the valid distances, its value at the nearer end.
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

    /// Refuses values that no fit gives.
    pub(in crate::terms) fn check_at(&self, here: &Check<'_>) -> Result<(), ParameterError> {
        let [min_m, max_m] = self.valid_distance_m;
        // As far as the tables of the hot loop reach.
        let ordered = 1e-4 <= min_m && min_m < max_m && max_m <= 1e5;
        let (range, expected) =
            (format!("{min_m}..{max_m}"), "two increasing distances in metres, 1e-4 to 1e5");
        here.at("valid_distance_m").require(ordered, range, expected)?;
        let reference_m = self.reference_distance_m;
        let covered = min_m <= reference_m && reference_m <= max_m;
        here.at("reference_distance_m").require(covered, reference_m, "a distance in the valid range")?;
        let count = self.coefficients.len();
        let fine = Self::COEFFICIENTS.contains(&count) && self.coefficients.iter().all(|c| c.is_finite());
        let found = format!("{count} coefficients, or one that is not finite");
        let coefficients = here.at("coefficients");
        coefficients.require(fine, found, "4 to 256 numbers")?;
        self.harmonic
            .map_or(Ok(()), |harmonic| Self::check_harmonic(harmonic, max_m, &here.at("harmonic")))?;
        let impossible = self.impossible().map(|(d, h)| format!("{h:.3e} at {d:.3} m"));
        let expected = "a multiplier from 1e-12 to 1e12 over its range";
        coefficients.require(impossible.is_none(), impossible.unwrap_or_default(), expected)?;
        let weight = self.curvature_weight;
        here.at("curvature_weight").require(weight >= 0.0 && weight.is_finite(), weight, "0 or more")
    }

    fn check_harmonic(harmonic: Harmonic, max_m: f64, here: &Check<'_>) -> Result<(), ParameterError> {
        let Harmonic { modulation_frequency_hz, cosine, sine } = harmonic;
        let angle = Harmonic::angle(modulation_frequency_hz, max_m);
        let fine = modulation_frequency_hz > 0.0 && angle <= Self::LARGEST_ANGLE;
        let expected = "a positive frequency with at most 40 ambiguity ranges in the valid distances";
        here.at("modulation_frequency_hz").require(fine, modulation_frequency_hz, expected)?;
        let largest = cosine.abs().max(sine.abs());
        let fine = cosine.abs() <= Self::LARGEST_HARMONIC && sine.abs() <= Self::LARGEST_HARMONIC;
        here.require(fine, largest, "coefficients from -0.5 to 0.5")
    }

    /// A distance in the valid range where the multiplier is impossible, and its value.
    fn impossible(&self) -> Option<(f64, f64)> {
        const STEPS: u32 = 512;
        let [min_m, max_m] = self.valid_distance_m;
        let distances = (0..=STEPS).map(|i| min_m * (max_m / min_m).powf(f64::from(i) / f64::from(STEPS)));
        distances.map(|d| (d, self.multiplier(d))).find(|(_, m)| !MULTIPLIER_LIMITS.contains(m))
    }
}
