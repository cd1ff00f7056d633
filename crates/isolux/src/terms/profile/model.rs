//! The fitted term: the profile, its support, its sources, and their form in the calibration file.

use serde::{Deserialize, Serialize};

use super::{Map, Places, RADIAL};
use crate::frame::Shape;
use crate::terms::check::{Check, ParameterError, Parameters};
use crate::terms::{FitQuality, MULTIPLIER_LIMITS, Source};

/// Illumination profile of one camera at one shape of images.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(from = "ProfileFile", into = "ProfileFile")]
pub struct Profile {
    /// Version of this term's parameters.
    pub version: u32,
    /// The profile; valid for images of its shape only. In the calibration file, its fields stand beside the
    /// others.
    pub map: Map,
    /// Its support: a map of 12 rows of 16 cells, `#` where the profile was observed.
    pub support: Vec<String>,
    /// The recordings that it was fitted to.
    pub fitted_on: Vec<Source>,
    /// How well all factors together fit the observations.
    pub fit: FitQuality,
    /// Warnings of the fit: what the user should know or record better.
    pub warnings: Vec<String>,
}

impl Profile {
    /// Parameter version that this library writes.
    pub const VERSION: u32 = 1;

    /// Height and width of the images that it holds for.
    #[must_use]
    pub fn shape(&self) -> Shape {
        self.map.places.shape
    }

    /// The image coordinates that it is a function of.
    #[must_use]
    pub fn places(&self) -> Places {
        self.map.places
    }

    /// [`Map::ln_gain`].
    #[must_use]
    pub fn ln_gain(&self, place: [f64; 2]) -> f64 {
        self.map.ln_gain(place)
    }

    /// True where the profile was observed.
    #[must_use]
    pub fn supports(&self, place: [f64; 2]) -> bool {
        self.places().cell(place).is_some_and(|cell| self.supports_cell(cell))
    }

    pub(super) fn supports_cell(&self, cell: usize) -> bool {
        let [along, _] = Places::CELLS;
        let row = self.support.get(cell / along).map(String::as_bytes);
        row.and_then(|row| row.get(cell % along)).is_some_and(|mark| *mark == b'#')
    }

    /// The map of support as the file holds it.
    pub(crate) fn support_map(is_supported: impl Fn(usize) -> bool) -> Vec<String> {
        let [along, down] = Places::CELLS;
        let mark = |cell: usize| if is_supported(cell) { '#' } else { '.' };
        (0..down).map(|row| (row * along..(row + 1) * along).map(mark).collect()).collect()
    }

    /// Refuses parameters that no fit gives.
    ///
    /// # Errors
    /// [`ParameterError`] names the field.
    pub fn check(&self) -> Result<(), ParameterError> {
        self.check_at(&Check::of(Self::NAME))
    }

    /// An impossible gain in a supported cell, if there is one.
    fn impossible(&self) -> Option<f64> {
        let places = self.map.places;
        let cells = (0..Places::CELLS[0] * Places::CELLS[1]).filter(|&cell| self.supports_cell(cell));
        let mut gains = cells.map(|cell| self.ln_gain(places.cell_centre(cell)).exp());
        gains.find(|gain| !MULTIPLIER_LIMITS.contains(gain))
    }
}

impl Parameters for Profile {
    const NAME: &'static str = "profile";

    fn check_at(&self, here: &Check<'_>) -> Result<(), ParameterError> {
        here.version(self.version, Self::VERSION)?;
        self.map.check_at(here)?;
        let [along, down] = Places::CELLS;
        let row = |row: &String| row.len() == along && row.bytes().all(|mark| matches!(mark, b'#' | b'.'));
        let fine = self.support.len() == down && self.support.iter().all(row);
        let support = here.at("support");
        support.require(fine, self.support.join("/"), "12 rows of 16 characters `#` or `.`")?;
        let seen = self.support.iter().any(|row| row.contains('#'));
        support.require(seen, "no `#`", "a profile that holds somewhere")?;
        let impossible = self.impossible().map(|gain| format!("a gain of {gain:.3e}"));
        let expected = "gains from 1e-12 to 1e12 over its support";
        here.at("tensor").require(impossible.is_none(), impossible.unwrap_or_default(), expected)
    }
}

/// The term as the calibration file holds it: the map's numbers beside those of their origin. By hand, because serde
/// cannot both flatten a struct and refuse unknown fields.
#[derive(Serialize, Deserialize)]
#[serde(rename = "Profile", deny_unknown_fields)]
struct ProfileFile {
    version: u32,
    height: usize,
    width: usize,
    origin_px: [f64; 2],
    radial: [f64; RADIAL],
    tensor: Vec<f64>,
    support: Vec<String>,
    fitted_on: Vec<Source>,
    fit: FitQuality,
    warnings: Vec<String>,
}

impl From<ProfileFile> for Profile {
    fn from(file: ProfileFile) -> Self {
        let places = Places { shape: Shape::new(file.height, file.width), origin: file.origin_px };
        let map = Map { places, radial: file.radial, tensor: file.tensor };
        let ProfileFile { version, support, fitted_on, fit, warnings, .. } = file;
        Self { version, map, support, fitted_on, fit, warnings }
    }
}

impl From<Profile> for ProfileFile {
    fn from(Profile { version, map, support, fitted_on, fit, warnings }: Profile) -> Self {
        let Map { places: Places { shape, origin }, radial, tensor } = map;
        Self {
            version,
            height: shape.height,
            width: shape.width,
            origin_px: origin,
            radial,
            tensor,
            support,
            fitted_on,
            fit,
            warnings,
        }
    }
}
