//! What surrounds a pixel, laid out so that a plane in space is a plane in the numbers.
//!
//! For rays r = (x, y, 1), in whatever axes, a plane `n · p = ρ` has the inverse depth `1/z = (n/ρ) · (x, y, 1)`: affine
//! in x and y. A pinhole has such rays in the axes of the camera. All other lenses get axes of their own around each
//! pixel, z along its ray, so that it does not matter how far off the camera's axis, or behind it, they look.

use crate::frame::{Intrinsics, PixelRays, RayTable, Shape};
use crate::numerics::plane_fit::LocalPlane;

/// Tangent of the steepest surface that a fit starts with: 68°.
const STEEPEST: f64 = 2.5;
/// That of a second try: 85°. A road before a lidar is met at such angles.
const GRAZING: f64 = 11.4;

/// The layout around a pixel.
pub(super) trait Layout {
    /// Tangents of the steepest surface that fits start with; the first that finds a plane counts.
    const STEEPEST: &'static [f64];

    /// Pixels per radian, in the direction that has fewer.
    fn focal_px(&self) -> f64;

    /// x, y and inverse depth of the pixel `j` columns and `i` rows away, at `index` in the image; NaN where there is
    /// none. `inverse` is what the image holds of it.
    fn place(&self, i: i64, j: i64, index: usize, inverse: f64) -> [f64; 3];

    /// Cosine of the angle between the pixel's ray and the normal of a plane around it.
    fn cosine(&self, plane: LocalPlane) -> f64;
}

/// Around a pixel of a pinhole.
#[derive(Clone, Copy, Debug)]
pub(super) struct Flat<'a> {
    pub(super) intrinsics: &'a Intrinsics,
    pub(super) pixel: (usize, usize),
}

impl Layout for Flat<'_> {
    const STEEPEST: &'static [f64] = &[STEEPEST];

    fn focal_px(&self) -> f64 {
        self.intrinsics.fx.min(self.intrinsics.fy)
    }

    #[inline(always)]
    fn place(&self, i: i64, j: i64, _: usize, inverse: f64) -> [f64; 3] {
        [j as f64 / self.intrinsics.fx, i as f64 / self.intrinsics.fy, inverse]
    }

    fn cosine(&self, plane: LocalPlane) -> f64 {
        let (row, column) = self.pixel;
        let [x, y, _] = self.intrinsics.ray(row as f64, column as f64);
        let along = plane.middle - plane.along_x * x - plane.along_y * y;
        let length = (plane.along_x * plane.along_x + plane.along_y * plane.along_y + along * along).sqrt();
        plane.middle / (length * radial_per_depth(self.intrinsics, self.pixel))
    }
}

/// Around a pixel of any other lens: axes across its ray.
#[derive(Clone, Copy, Debug)]
pub(super) struct Turned<'a> {
    unit: &'a [[f64; 3]],
    /// x, y and, along the pixel's ray, z.
    axes: [[f64; 3]; 3],
    focal_px: f64,
}

impl<'a> Turned<'a> {
    /// `None` where the pixel, or all beside it in a row or column, see nothing.
    pub(super) fn new(table: &'a RayTable, (row, column): (usize, usize)) -> Option<Self> {
        let ahead = table.get(row, column)?;
        let focal_px = pixels_per_radian(table, (row, column), ahead)?;
        // Any axes across the ray will do; the first one starts from where the ray points least.
        let least = (0..3).min_by(|a, b| ahead[*a].abs().total_cmp(&ahead[*b].abs()))?;
        let mut x = ahead.map(|value| -value * ahead[least]);
        x[least] += 1.0;
        let length = dot(x, x).sqrt();
        let x = x.map(|value| value / length);
        Some(Self { unit: table.unit(), axes: [x, cross(ahead, x), ahead], focal_px })
    }
}

impl Layout for Turned<'_> {
    const STEEPEST: &'static [f64] = &[STEEPEST, GRAZING];

    fn focal_px(&self) -> f64 {
        self.focal_px
    }

    #[inline(always)]
    fn place(&self, _: i64, _: i64, index: usize, inverse: f64) -> [f64; 3] {
        /// Rays farther apart, 60°, are no neighbours.
        const LEAST_ALONG: f64 = 0.5;
        let [x, y, along] = self.axes.map(|axis| dot(axis, self.unit[index]));
        if along > LEAST_ALONG { [x / along, y / along, inverse / along] } else { [f64::NAN; 3] }
    }

    fn cosine(&self, plane: LocalPlane) -> f64 {
        let LocalPlane { middle, along_x, along_y } = plane;
        middle / (along_x * along_x + along_y * along_y + middle * middle).sqrt()
    }
}

/// From the nearest pixel of the row and of the column that sees something, in the direction that has fewer.
fn pixels_per_radian(table: &RayTable, (row, column): (usize, usize), ray: [f64; 3]) -> Option<f64> {
    let per_radian = |other: Option<[f64; 3]>| {
        let across = cross(ray, other?);
        let sine = dot(across, across).sqrt();
        (sine > 0.0).then(|| 1.0 / sine)
    };
    let right = per_radian(table.get(row, column + 1));
    let below = per_radian(table.get(row + 1, column));
    let left = || per_radian(table.get(row, column.checked_sub(1)?));
    let above = || per_radian(table.get(row.checked_sub(1)?, column));
    Some(right.or_else(left)?.min(below.or_else(above)?))
}

/// What turns the distance of each pixel into its inverse depth: radial distance per metre of depth in the axes that the
/// pixel is laid out in. NaN where it sees nothing.
pub(super) fn inverse_scale(rays: &PixelRays, shape: Shape, index: usize) -> f64 {
    match rays {
        PixelRays::Pinhole(intrinsics) => radial_per_depth(intrinsics, shape.place(index)),
        // Along its own ray, the depth is the distance.
        PixelRays::Table(table) if table.unit().get(index).is_some_and(|ray| !ray[0].is_nan()) => 1.0,
        PixelRays::Table(_) => f64::NAN,
    }
}

/// Radial distance per metre of depth at a pixel of a pinhole.
pub(super) fn radial_per_depth(intrinsics: &Intrinsics, (row, column): (usize, usize)) -> f64 {
    let [x, y, z] = intrinsics.ray(row as f64, column as f64);
    (x * x + y * y + z * z).sqrt()
}

#[inline(always)]
fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}
