//! The plane around each pixel, fitted to the distances around it, and the angle at which the light meets it.
//!
//! On a plane, the inverse depth is an affine function of the image: `1/z = a x + b y + c`, with the ray (x, y, 1),
//! and (a, b, c) is parallel to the normal. A fit of 1/z is therefore linear, without a bias from the slant. Each
//! window holds 9×9 samples; where the distances are noisy, they are farther apart. A window reaches across edges
//! of depth, so the fit is robust: it starts in the window's inner half with what a surface through the middle
//! pixel could hold at all, and closes in on the plane that the majority lies on (Tukey's biweight, the cutoff at
//! three times the weighted root mean square, at best halved from round to round). `neighbourhood` lays out the rays of
//! any lens like that.

use super::neighbourhood::{Flat, Layout, Turned};
use crate::frame::{PixelRays, Shape};
use crate::numerics::plane_fit::{LocalPlane, PlaneMoments};
use crate::numerics::robust::biweight;

/// Samples to either side of the middle one.
const REACH: i64 = 4;
/// Half of the narrowest window, tangent of the angle: 2°, 35 mm at 1 m. Within less, a camera's depth follows the
/// texture more than the slant.
const NARROWEST: f64 = 0.034;
/// Most pixels from sample to sample: the distances that are sampled are means over 5×5, so that more would leave
/// some out.
const WIDEST_STEP: i64 = 5;
/// Predicted error of the slant that widens the window, rad.
const LARGEST_ERROR: f64 = 0.02;
/// Samples to either side with which a fit starts: the window's inner half, which an edge reaches less often.
const NEAR_REACH: i64 = 2;
/// Standard deviations of a pixel's distance, before it was denoised, that a fit starts with besides.
const NOISE_MARGIN: f64 = 1.0;
/// Larger relative deviations do not widen the start: they would let in everything.
const LARGEST_NOISE: f64 = 0.1;
/// Rounds with the inner half, and all.
const NEAR_ROUNDS: usize = 2;
const ROUNDS: usize = 6;
/// A cutoff is never less than this share of 1/z: what cameras' distances err by on any surface.
const LEAST_CUTOFF: f64 = 0.004;
/// Samples that a plane needs: as many as the inner half holds in the image's corner.
const LEAST_SAMPLES: u32 = 9;
/// Least ratio of the determinant of the samples' spread to the square of half its trace: a line has no plane.
const LEAST_SPREAD: f64 = 0.02;

/// What the fits of one frame share.
pub(super) struct Field<'a> {
    pub(super) shape: Shape,
    pub(super) rays: &'a PixelRays,
    /// Inverse depth of each pixel, 1/m, in the axes that it is laid out in; NaN where there is no distance.
    pub(super) inverse_depth: &'a [f32],
}

impl Field<'_> {
    /// Cosine of the angle of incidence at a pixel; `noise`: relative standard deviation of its distance.
    pub(super) fn cosine(&self, index: usize, noise: f64) -> Option<f64> {
        let pixel = self.shape.place(index);
        match self.rays {
            PixelRays::Pinhole(intrinsics) => self.cosine_in(&Flat { intrinsics, pixel }, pixel, noise),
            PixelRays::Table(table) => self.cosine_in(&Turned::new(table, pixel)?, pixel, noise),
        }
    }

    fn cosine_in<L: Layout>(&self, layout: &L, pixel: (usize, usize), noise: f64) -> Option<f64> {
        let step = step(layout.focal_px(), noise);
        let plane = |&steepest: &f64| self.plane(layout, pixel, step, noise, steepest);
        let cosine = layout.cosine(L::STEEPEST.iter().find_map(plane)?);
        (cosine > 0.0).then(|| cosine.min(1.0))
    }

    /// `1/z = middle + along_x Δx + along_y Δy` around a pixel.
    fn plane<L: Layout>(
        &self,
        layout: &L,
        (row, column): (usize, usize),
        step: i64,
        noise: f64,
        steepest: f64,
    ) -> Option<LocalPlane> {
        let middle = f64::from(self.inverse_depth[row * self.shape.width + column]);
        let near = steepest * (NEAR_REACH * step) as f64 / layout.focal_px();
        let mut cutoff = middle * (near + NOISE_MARGIN * noise.min(LARGEST_NOISE));
        let mut plane = LocalPlane::level(middle);
        for round in 0..ROUNDS {
            let reach = if round < NEAR_ROUNDS { NEAR_REACH } else { REACH };
            let samples = self.samples(layout, (row, column), reach, step, plane, cutoff);
            let before = plane;
            plane = samples.corrected(plane)?;
            let closest = cutoff <= LEAST_CUTOFF * middle * 1.001;
            if closest && round >= NEAR_ROUNDS && are_close(plane, before) {
                break;
            }
            // The plane of half the window is less certain in the whole window.
            let widens = if round + 1 == NEAR_ROUNDS { 1.5 } else { 1.0 };
            let closer = 3.0 * samples.root_mean_square() * widens;
            cutoff = closer.clamp(0.5 * cutoff, cutoff).max(LEAST_CUTOFF * middle);
        }
        // A pixel that its own plane leaves out lies on an edge or is an outlier: it has no normal.
        ((middle - plane.middle).abs() < cutoff.max(3.0 * noise * middle)).then_some(plane)
    }

    /// The samples within `cutoff` of the `known` plane.
    fn samples<L: Layout>(
        &self,
        layout: &L,
        (row, column): (usize, usize),
        reach: i64,
        step: i64,
        known: LocalPlane,
        cutoff: f64,
    ) -> Samples {
        let (height, width) = (self.shape.height as i64, self.shape.width as i64);
        let inverse_square = 1.0 / (cutoff * cutoff);
        let mut samples = Samples::default();
        for i in -reach..=reach {
            let y = row as i64 + i * step;
            if y < 0 || y >= height {
                continue;
            }
            for j in -reach..=reach {
                let x = column as i64 + j * step;
                if x < 0 || x >= width {
                    continue;
                }
                let index = (y * width + x) as usize;
                let inverse = f64::from(self.inverse_depth[index]);
                let [dx, dy, value] = layout.place(i * step, j * step, index, inverse);
                let residual = value - known.middle - known.along_x * dx - known.along_y * dy;
                let share = residual * residual * inverse_square;
                // False for NaN.
                if share < 1.0 {
                    samples.add(biweight(share), dx, dy, residual);
                }
            }
        }
        samples
    }
}

/// What a plane is fitted to.
#[derive(Clone, Copy, Debug, Default)]
struct Samples {
    count: u32,
    moments: PlaneMoments,
    /// Weighted sum of squared residuals.
    squares: f64,
}

impl Samples {
    #[inline(always)]
    fn add(&mut self, w: f64, x: f64, y: f64, r: f64) {
        self.count += 1;
        self.moments.add(w, x, y, r);
        self.squares += w * r * r;
    }

    fn root_mean_square(&self) -> f64 {
        (self.squares / self.moments.weight()).sqrt()
    }

    /// The known plane and that of the residuals; `None` where the samples determine none.
    fn corrected(&self, known: LocalPlane) -> Option<LocalPlane> {
        if self.count < LEAST_SAMPLES {
            return None;
        }
        self.moments.corrected(known, LEAST_SPREAD)
    }
}

/// Pixels from sample to sample: the slant of N pixels within a half width of R has the standard error
/// `σ/d · √3 f / (R √N)`.
fn step(focal_px: f64, noise: f64) -> i64 {
    let narrowest = ((NARROWEST * focal_px / REACH as f64).round() as i64).clamp(1, 64);
    let error = |step: i64| {
        let half = (REACH * step) as f64;
        noise * 3f64.sqrt() * focal_px / (half * (2.0 * half + 1.0))
    };
    let mut step = narrowest;
    while step < WIDEST_STEP && error(step) > LARGEST_ERROR {
        step += 1;
    }
    step
}

/// Within a thousandth of the slant.
fn are_close(plane: LocalPlane, other: LocalPlane) -> bool {
    let limit = 1e-3 * plane.middle.abs();
    (plane.along_x - other.along_x).abs() < limit && (plane.along_y - other.along_y).abs() < limit
}
