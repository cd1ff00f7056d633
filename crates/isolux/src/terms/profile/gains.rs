//! The profile as a plane of multipliers, one for each pixel.

use super::{Places, Profile, Surface};
use crate::frame::Plane;

/// Steps on the line to the origin in which the edge of the support is searched.
const STEPS: u32 = 128;

/// The multipliers of a whole image.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct ProfileGains {
    /// 1/v of every pixel.
    pub(crate) gains: Plane<f32>,
    /// True where the pixel lies outside the support.
    pub(crate) outside: Vec<bool>,
}

impl Profile {
    /// The multipliers 1/v of its images.
    pub(crate) fn gains(&self) -> ProfileGains {
        let (places, surface) = (self.map.places, Surface::new(&self.map.places));
        let mut outside = Vec::with_capacity(self.shape().pixels());
        let gains = Plane::from_fn(self.shape(), |row, column| {
            let place = places.at(row as f64, column as f64);
            let supported = self.supports(place);
            outside.push(!supported);
            let place = if supported { place } else { self.nearest_supported(&places, place) };
            (-surface.sum(&self.map.radial, &self.map.tensor, place)).exp() as f32
        });
        ProfileGains { gains, outside }
    }

    /// The last supported place on the line from the origin; where there is none, the middle of the nearest
    /// supported cell.
    fn nearest_supported(&self, places: &Places, [x, y]: [f64; 2]) -> [f64; 2] {
        let on_the_way = (0..STEPS).rev().map(|step| f64::from(step) / f64::from(STEPS));
        if let Some(share) = on_the_way.into_iter().find(|share| self.supports([share * x, share * y])) {
            return [share * x, share * y];
        }
        let cells = (0..Places::CELLS[0] * Places::CELLS[1]).filter(|&cell| self.supports_cell(cell));
        let squared = |[a, b]: &[f64; 2]| (a - x).powi(2) + (b - y).powi(2);
        let nearest =
            cells.map(|cell| places.cell_centre(cell)).min_by(|a, b| squared(a).total_cmp(&squared(b)));
        nearest.unwrap_or([0.0; 2])
    }
}
