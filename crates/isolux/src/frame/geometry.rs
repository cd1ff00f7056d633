//! Pinhole geometry: rays, and the ratio of radial distance to depth.

use serde::{Deserialize, Serialize};

use super::{Plane, Shape};

/// Pinhole intrinsics in pixels. (0, 0) is the centre of the upper left pixel.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Intrinsics {
    /// Focal length along a row, pixels.
    pub fx: f64,
    /// Focal length along a column, pixels.
    pub fy: f64,
    /// Column of the principal point, pixels.
    pub cx: f64,
    /// Row of the principal point, pixels.
    pub cy: f64,
}

impl Intrinsics {
    /// True when a ray can be computed: focal lengths positive, all values finite.
    #[must_use]
    pub fn is_usable(&self) -> bool {
        [self.fx, self.fy, self.cx, self.cy].iter().all(|value| value.is_finite())
            && self.fx > 0.0
            && self.fy > 0.0
    }

    /// The point at depth 1 that the pixel sees: (x, y, 1) in metres per metre of depth.
    #[must_use]
    pub fn ray(&self, row: f64, column: f64) -> [f64; 3] {
        [(column - self.cx) / self.fx, (row - self.cy) / self.fy, 1.0]
    }

    /// Radial distance per metre of depth, for every pixel: ≥ 1, dimensionless.
    #[must_use]
    pub fn radial_per_depth(&self, shape: Shape) -> Plane<f32> {
        Plane::from_fn(shape, |row, column| {
            let [x, y, z] = self.ray(row as f64, column as f64);
            (x * x + y * y + z * z).sqrt() as f32
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pixel_at_45_degrees_is_root_two_away() {
        let intrinsics = Intrinsics { fx: 2.0, fy: 2.0, cx: 1.0, cy: 1.0 };
        let ratio = intrinsics.radial_per_depth(Shape::new(4, 4));
        assert_eq!(ratio.get(1, 1), Some(1.0));
        assert_eq!(ratio.get(1, 3), Some(2f32.sqrt()));
    }
}
