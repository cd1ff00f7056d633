//! The coefficients of the profile, its value at a place, and the check.

use super::{Places, RADIAL, Surface};
use crate::terms::check::{Check, ParameterError};

/// An illumination profile: `ln v = c₁ r² + c₂ r⁴ + Σ c_kl B_k(x) B_l(y)`.
#[derive(Clone, Debug, PartialEq)]
pub struct Map {
    /// The image coordinates that it is a function of. Their origin is where v = 1.
    pub places: Places,
    /// Coefficients of r² and r⁴, r in half diagonals.
    pub radial: [f64; RADIAL],
    /// Coefficients of the tensor of B-splines: 8 along the first row, then those of the next of 6.
    pub tensor: Vec<f64>,
}

impl Map {
    /// Largest number of rows or columns.
    const LARGEST: usize = 1 << 14;

    /// ln v at a place, supported or not: 0 at the origin.
    #[must_use]
    pub fn ln_gain(&self, place: [f64; 2]) -> f64 {
        Surface::new(&self.places).sum(&self.radial, &self.tensor, place)
    }

    /// Refuses values that no fit gives.
    pub(super) fn check_at(&self, here: &Check<'_>) -> Result<(), ParameterError> {
        let (format, shape) = (1..=Self::LARGEST, self.places.shape);
        let fine = format.contains(&shape.height) && format.contains(&shape.width);
        here.at("height").require(fine, shape, "an image of 1 to 16384 rows and columns")?;
        let [row, column] = self.places.origin;
        let near = |value: f64, pixels: usize| value.abs() <= 4.0 * pixels as f64;
        let fine = near(row, shape.height) && near(column, shape.width);
        here.at("origin_px").require(
            fine,
            format!("{row}, {column}"),
            "a row and a column near the image",
        )?;
        let fine = self.radial.iter().all(|c| c.is_finite());
        here.at("radial").require(fine, format!("{:?}", self.radial), "two finite numbers")?;
        let count = self.tensor.len();
        let fine = count == Surface::TENSOR_LEN && self.tensor.iter().all(|c| c.is_finite());
        let found = format!("{count} coefficients, or one that is not finite");
        here.at("tensor").require(fine, found, "48 finite numbers")
    }
}
