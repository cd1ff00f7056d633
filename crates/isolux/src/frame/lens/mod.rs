//! Lenses: which direction each pixel of a camera looks in.
//!
//! A [`Lens`] is what a recording says of it. [`PixelRays`] are the directions of all pixels of an image: computed once,
//! so that work on a frame solves no equation of a lens.

mod distortion;
mod error;
mod fisheye;
mod pixel_rays;
mod polynomial;
mod ray_table;
mod solve;
mod spinning;
#[cfg(test)]
mod tests;

use std::fmt;
use std::sync::Arc;

pub use distortion::Distortion;
pub use error::LensError;
pub use pixel_rays::PixelRays;
pub use ray_table::RayTable;
pub use spinning::SpinningLidar;

use super::{Intrinsics, Shape};

/// The lens of a camera. Cheap to clone.
///
/// The axes of a camera are x to the right, y down and z ahead. Those of a [`SpinningLidar`] are its own.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Lens {
    /// Straight lines stay straight.
    Pinhole(Intrinsics),
    /// A pinhole whose image is distorted by a model.
    Distorted(Intrinsics, Distortion),
    /// Beams at fixed altitudes that turn about an axis.
    Spinning(Arc<SpinningLidar>),
    /// The direction of every pixel, in a table.
    Rays(Arc<RayTable>),
}

impl From<Intrinsics> for Lens {
    fn from(pinhole: Intrinsics) -> Self {
        Self::Pinhole(pinhole)
    }
}

impl Lens {
    /// True when rays can be computed: focal lengths positive, all values finite. The other lenses are checked when they
    /// are made.
    #[must_use]
    pub fn is_usable(&self) -> bool {
        match self {
            Self::Pinhole(pinhole) | Self::Distorted(pinhole, _) => pinhole.is_usable(),
            Self::Spinning(_) | Self::Rays(_) => true,
        }
    }

    /// Fails where the lens is not one of images of this shape.
    ///
    /// # Errors
    /// [`LensError`] says what the lens describes instead, or that no pixel of such images has a ray.
    pub fn check_shape(&self, shape: Shape) -> Result<(), LensError> {
        match self {
            Self::Pinhole(_) => Ok(()),
            Self::Distorted(..) => {
                let sees = |index: usize| {
                    let (row, column) = shape.place(index);
                    self.ray(shape, row, column).is_some()
                };
                if (0..shape.pixels()).any(sees) { Ok(()) } else { Err(LensError::SeesNothing) }
            }
            Self::Spinning(lidar) => lidar.check_shape(shape),
            Self::Rays(table) if table.shape() == shape => Ok(()),
            Self::Rays(table) => Err(LensError::TableShape { found: table.shape(), expected: shape }),
        }
    }

    /// Row and column of the principal point, pixels, where the lens has one.
    #[must_use]
    pub fn principal_point(&self) -> Option<[f64; 2]> {
        match self {
            Self::Pinhole(pinhole) | Self::Distorted(pinhole, _) => Some([pinhole.cy, pinhole.cx]),
            Self::Spinning(_) | Self::Rays(_) => None,
        }
    }

    /// The same lens with focal lengths that are `factor` times as long; `None` for a lens that has none.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Option<Self> {
        let scale = |p: &Intrinsics| Intrinsics { fx: p.fx * factor, fy: p.fy * factor, ..*p };
        match self {
            Self::Pinhole(pinhole) => Some(Self::Pinhole(scale(pinhole))),
            Self::Distorted(pinhole, distortion) => Some(Self::Distorted(scale(pinhole), *distortion)),
            Self::Spinning(_) | Self::Rays(_) => None,
        }
    }

    /// The direction that a pixel of an image of `shape` looks in, of any length; that of a pinhole has z = 1. `None`
    /// where the pixel sees nothing: outside the domain of a distortion, or of a table.
    #[must_use]
    pub fn ray(&self, shape: Shape, row: usize, column: usize) -> Option<[f64; 3]> {
        let (y, x) = (row as f64, column as f64);
        match self {
            Self::Pinhole(pinhole) => Some(pinhole.ray(y, x)),
            Self::Distorted(pinhole, distortion) => {
                let [x, y, _] = pinhole.ray(y, x);
                distortion.ray([x, y])
            }
            Self::Spinning(lidar) => lidar.ray(shape, row, column),
            Self::Rays(table) => table.get(row, column),
        }
    }

    /// The directions of all pixels of images of `shape`.
    #[must_use]
    pub fn pixel_rays(&self, shape: Shape) -> PixelRays {
        match self {
            Self::Pinhole(pinhole) => PixelRays::Pinhole(*pinhole),
            Self::Rays(table) if table.shape() == shape => PixelRays::Table(Arc::clone(table)),
            _ => {
                let ray = |row, column| self.ray(shape, row, column);
                PixelRays::Table(Arc::new(RayTable::from_fn(shape, ray)))
            }
        }
    }

    /// Row and column, fractions of pixels, where an image of `shape` shows a point in the axes of the camera; `None`
    /// where it does not, and for a table of rays, which tells directions of pixels and not the reverse.
    #[must_use]
    pub fn project(&self, shape: Shape, point: [f64; 3]) -> Option<[f64; 2]> {
        match self {
            Self::Pinhole(pinhole) => {
                let [x, y, z] = point;
                (z > 0.0).then(|| [pinhole.fy * y / z + pinhole.cy, pinhole.fx * x / z + pinhole.cx])
            }
            Self::Distorted(pinhole, distortion) => {
                let [x, y] = distortion.image(point)?;
                Some([pinhole.fy * y + pinhole.cy, pinhole.fx * x + pinhole.cx])
            }
            Self::Spinning(lidar) => lidar.project(shape, point),
            Self::Rays(_) => None,
        }
    }

    /// True where [`Self::project`] finds the pixels of points.
    #[must_use]
    pub fn can_project(&self) -> bool {
        !matches!(self, Self::Rays(_))
    }

    /// True where each pixel looks along an optical axis z that depths can be measured along.
    #[must_use]
    pub fn has_axis(&self) -> bool {
        !matches!(self, Self::Spinning(_))
    }
}

/// The lens in words: "Kannala–Brandt fisheye, 4 coefficients".
impl fmt::Display for Lens {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Pinhole(_) => f.write_str("pinhole"),
            Self::Distorted(_, distortion) => distortion.fmt(f),
            Self::Spinning(lidar) => write!(f, "spinning lidar, {} beams", lidar.beams()),
            Self::Rays(_) => f.write_str("table of rays"),
        }
    }
}
