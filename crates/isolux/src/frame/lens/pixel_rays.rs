//! The directions of all pixels of an image, ready to use.

use std::sync::Arc;

use super::ray_table::RayTable;
use crate::frame::{Intrinsics, Plane, Shape};

/// The directions that the pixels of images of one shape look in; [`Lens::pixel_rays`](super::Lens::pixel_rays)
/// computes them. Cheap to clone.
#[derive(Clone, Debug, PartialEq)]
pub enum PixelRays {
    /// Those of a pinhole are computed where they are needed.
    Pinhole(Intrinsics),
    /// All others stand in a table.
    Table(Arc<RayTable>),
}

impl PixelRays {
    /// The direction of a pixel: of z = 1 for a pinhole, otherwise of unit length. NaN where it sees nothing.
    #[must_use]
    pub fn ray(&self, row: usize, column: usize) -> [f64; 3] {
        match self {
            Self::Pinhole(pinhole) => pinhole.ray(row as f64, column as f64),
            Self::Table(table) => table.get(row, column).unwrap_or([f64::NAN; 3]),
        }
    }

    /// False for a table of another shape.
    #[must_use]
    pub fn fits(&self, shape: Shape) -> bool {
        match self {
            Self::Pinhole(_) => true,
            Self::Table(table) => table.shape() == shape,
        }
    }

    /// Radial distance per metre of depth, for every pixel: ≥ 1, dimensionless. NaN where a pixel sees nothing or looks
    /// to the side or back: there, a depth is no distance.
    #[must_use]
    pub fn radial_per_depth(&self, shape: Shape) -> Plane<f32> {
        match self {
            Self::Pinhole(pinhole) => pinhole.radial_per_depth(shape),
            Self::Table(_) => Plane::from_fn(shape, |row, column| {
                let [_, _, z] = self.ray(row, column);
                if z > 0.0 { (1.0 / z) as f32 } else { f32::NAN }
            }),
        }
    }

    /// Number of pixels that see nothing.
    #[must_use]
    pub fn blind_pixels(&self) -> usize {
        match self {
            Self::Pinhole(_) => 0,
            Self::Table(table) => table.unit().iter().filter(|ray| ray[0].is_nan()).count(),
        }
    }
}
