//! `profile`: the illumination profile of lobe and lens, a gain of each pixel (beyond the paper):
//! `ln v(x, y) = c₁ r² + c₂ r⁴ + Σ c_kl B_k(x) B_l(y)`, `v(origin) = 1`; x and y from the principal point in units of the
//! half diagonal, B cubic B-splines on equal intervals, 8 along a row and 6 along a column.
//!
//! The profile holds where the target was seen. A pixel elsewhere gets the value of the last supported place on the way
//! from the origin to it, and a flag.

mod places;
mod surface;
#[cfg(test)]
mod tests;

use serde::{Deserialize, Serialize};

pub use places::Places;
pub(crate) use surface::{RADIAL, Surface};

use super::{FitQuality, MULTIPLIER_LIMITS, ParameterError, Source, require};
use crate::frame::{Plane, Shape};

/// Illumination profile of one camera at one image format.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Profile {
    /// Version of this term's parameters.
    pub version: u32,
    /// Rows of the images that it was fitted on; it holds for no other format.
    pub height: usize,
    /// Columns of those images.
    pub width: usize,
    /// Row and column of the origin, where v = 1: the principal point where it was known, otherwise the centre.
    pub origin_px: [f64; 2],
    /// Coefficients of r² and r⁴, r in half diagonals.
    pub radial: [f64; RADIAL],
    /// Coefficients of the tensor of B-splines: 8 along the first row, then those of the next of 6.
    pub tensor: Vec<f64>,
    /// Where it was seen: a map of 12 rows of 16 cells, `#` where it holds.
    pub support: Vec<String>,
    /// What it was fitted on.
    pub fitted_on: Vec<Source>,
    /// How well all factors together fit: windows of the target.
    pub fit: FitQuality,
    /// What the user should know or record better.
    pub warnings: Vec<String>,
}

/// The multipliers of a whole image.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct ProfileGains {
    /// 1/v of every pixel.
    pub(crate) gains: Plane<f32>,
    /// True where the pixel lies outside the support.
    pub(crate) outside: Vec<bool>,
}

impl Profile {
    /// Parameter version that this library writes.
    pub const VERSION: u32 = 1;
    /// Largest number of rows or columns.
    const LARGEST: usize = 1 << 14;
    /// Steps on the way to the origin in which the edge of the support is looked for.
    const STEPS: u32 = 128;

    /// Height and width of the images that it holds for.
    #[must_use]
    pub fn shape(&self) -> Shape {
        Shape::new(self.height, self.width)
    }

    /// The image coordinates that it is a function of.
    #[must_use]
    pub fn places(&self) -> Places {
        Places { shape: self.shape(), origin: self.origin_px }
    }

    /// ln v at a place, supported or not: 0 at the origin.
    #[must_use]
    pub fn ln_gain(&self, place: [f64; 2]) -> f64 {
        Surface::new(&self.places()).sum(&self.radial, &self.tensor, place)
    }

    /// True where the profile was seen.
    #[must_use]
    pub fn supports(&self, place: [f64; 2]) -> bool {
        self.places().cell(place).is_some_and(|cell| self.supports_cell(cell))
    }

    fn supports_cell(&self, cell: usize) -> bool {
        let [along, _] = Places::CELLS;
        let row = self.support.get(cell / along).map(String::as_bytes);
        row.and_then(|row| row.get(cell % along)).is_some_and(|mark| *mark == b'#')
    }

    /// The multipliers 1/v of its images.
    pub(crate) fn gains(&self) -> ProfileGains {
        let (places, surface) = (self.places(), Surface::new(&self.places()));
        let mut outside = Vec::with_capacity(self.shape().pixels());
        let gains = Plane::from_fn(self.shape(), |row, column| {
            let place = places.at(row as f64, column as f64);
            let supported = self.supports(place);
            outside.push(!supported);
            let place = if supported { place } else { self.nearest_supported(&places, place) };
            (-surface.sum(&self.radial, &self.tensor, place)).exp() as f32
        });
        ProfileGains { gains, outside }
    }

    /// The last supported place on the way from the origin; where there is none, the middle of the nearest supported
    /// cell.
    fn nearest_supported(&self, places: &Places, [x, y]: [f64; 2]) -> [f64; 2] {
        let on_the_way = (0..Self::STEPS).rev().map(|step| f64::from(step) / f64::from(Self::STEPS));
        if let Some(share) = on_the_way.into_iter().find(|share| self.supports([share * x, share * y])) {
            return [share * x, share * y];
        }
        let cells = (0..Places::CELLS[0] * Places::CELLS[1]).filter(|&cell| self.supports_cell(cell));
        let squared = |[a, b]: &[f64; 2]| (a - x).powi(2) + (b - y).powi(2);
        let nearest =
            cells.map(|cell| places.cell_centre(cell)).min_by(|a, b| squared(a).total_cmp(&squared(b)));
        nearest.unwrap_or([0.0; 2])
    }

    /// The map of support as the file holds it.
    pub(crate) fn support_map(is_supported: impl Fn(usize) -> bool) -> Vec<String> {
        let [along, down] = Places::CELLS;
        let mark = |cell: usize| if is_supported(cell) { '#' } else { '.' };
        (0..down).map(|row| (row * along..(row + 1) * along).map(mark).collect()).collect()
    }

    /// Refuses parameters that no fit can have written.
    ///
    /// # Errors
    /// [`ParameterError`] names the field.
    pub fn check(&self) -> Result<(), ParameterError> {
        require(self.version == Self::VERSION, "profile.version", self.version, "1")?;
        let format = 1..=Self::LARGEST;
        let fine = format.contains(&self.height) && format.contains(&self.width);
        require(fine, "profile.height", self.shape(), "an image of 1 to 16384 rows and columns")?;
        let [row, column] = self.origin_px;
        let near = |value: f64, pixels: usize| value.abs() <= 4.0 * pixels as f64;
        let fine = near(row, self.height) && near(column, self.width);
        require(fine, "profile.origin_px", format!("{row}, {column}"), "a row and a column near the image")?;
        let fine = self.radial.iter().all(|c| c.is_finite());
        require(fine, "profile.radial", format!("{:?}", self.radial), "two finite numbers")?;
        let count = self.tensor.len();
        let fine = count == Surface::TENSOR_LEN && self.tensor.iter().all(|c| c.is_finite());
        require(
            fine,
            "profile.tensor",
            format!("{count} coefficients, or one that is not finite"),
            "48 finite numbers",
        )?;
        let [along, down] = Places::CELLS;
        let row = |row: &String| row.len() == along && row.bytes().all(|mark| matches!(mark, b'#' | b'.'));
        let fine = self.support.len() == down && self.support.iter().all(row);
        require(fine, "profile.support", self.support.join("/"), "12 rows of 16 characters `#` or `.`")?;
        let seen = self.support.iter().any(|row| row.contains('#'));
        require(seen, "profile.support", "no `#`", "a profile that holds somewhere")?;
        let impossible = self.impossible().map_or_else(String::new, |gain| format!("a gain of {gain:.3e}"));
        let expected = "gains from 1e-12 to 1e12 over its support";
        require(impossible.is_empty(), "profile.tensor", impossible, expected)
    }

    /// A gain beyond all reason in a supported cell.
    fn impossible(&self) -> Option<f64> {
        let places = self.places();
        let cells = (0..Places::CELLS[0] * Places::CELLS[1]).filter(|&cell| self.supports_cell(cell));
        let mut gains = cells.map(|cell| self.ln_gain(places.cell_centre(cell)).exp());
        gains.find(|gain| !MULTIPLIER_LIMITS.contains(gain))
    }
}
