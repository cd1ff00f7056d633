//! `plane`: in the 7×7 pixels around each, a plane is fitted to those that lie on the same surface.
//!
//! The [`super::wiener`] image decides which pixels lie on the same surface. A pixel where that image differs from
//! the plane by more than its own noise counts less, and not at all beyond three standard deviations (Tukey's
//! biweight). A first plane is fitted to that image; a second, which gives the result, is fitted to the measured
//! distances that lie on the first, weighted by `1/σ_d²`. The measured distances do not decide themselves which of
//! them count, because then their noise would. Unlike a mean, a plane does not distort slanted surfaces, and uneven
//! weights do not tilt it, so that the texture of the amplitude has no effect.

use super::image::Image;
use super::wiener::Wiener;
use crate::memory::bytes;
use crate::numerics::plane_fit::{LocalPlane, PlaneMoments};

/// Pixels to either side.
pub(super) const RADIUS: usize = 3;
/// Beyond this many standard deviations a pixel belongs to another surface.
const CUTOFF: f64 = 3.0;
/// Variance that the guide keeps of one pixel's where nothing is detail: (85/625)² = 0.018 would be left by two
/// boxes of 5×5 one after the other, but the noise passes for detail here and there. Measured on flat areas.
const SMOOTHED_VARIANCE: f64 = 0.06;
/// Factor on the variance, because the noise has an influence on which pixels count as lying on the plane. Measured
/// on flat areas: 1.1 where nothing was left out, 1.4 over all pixels.
const CHOSEN_BY_NOISE: f64 = 1.2;
/// Pixels in less than two dimensions determine no plane: least ratio of the determinant of their spread to the
/// square of half its trace.
const LEAST_SPREAD: f64 = 1e-3;

/// Working memory: the image that decides which pixels lie on one surface.
#[derive(Clone, Debug, Default)]
pub(super) struct Guide {
    distance_m: Vec<f32>,
    /// Share of the detail, 0..1, that the guide left in, noise included.
    detail: Vec<f32>,
}

impl Guide {
    pub(super) fn bytes(&self) -> usize {
        bytes(&self.distance_m) + bytes(&self.detail)
    }

    /// Writes the denoised distances, NaN where the pixel does not count, and into `left` the share of each pixel's
    /// variance that is left.
    pub(super) fn denoise(
        &mut self,
        image: Image<'_>,
        k: f64,
        wiener: &mut Wiener,
        out: &mut [f32],
        mut left: Option<&mut [f32]>,
    ) {
        if k <= 0.0 {
            out.copy_from_slice(image.distance_m);
            if let Some(left) = left {
                left.fill(1.0);
            }
            return;
        }
        self.distance_m.resize(out.len(), 0.0);
        self.detail.resize(out.len(), 0.0);
        wiener.denoise(image, k, &mut self.distance_m, Some(&mut self.detail));
        for (index, out) in out.iter_mut().enumerate() {
            let known = !image.distance_m[index].is_nan();
            let (distance_m, variance) =
                if known { self.pixel(image, k, index) } else { (f32::NAN, f64::NAN) };
            *out = distance_m;
            if let Some(left) = &mut left {
                let amplitude = f64::from(image.amplitude[index]);
                left[index] = (amplitude * amplitude * variance).min(1.0) as f32;
            }
        }
    }

    /// The distance, and its variance over `k`.
    fn pixel(&self, image: Image<'_>, k: f64, index: usize) -> (f32, f64) {
        let (y, x) = image.shape.place(index);
        let level = LocalPlane::level(f64::from(self.distance_m[index]));
        let roughly = self.members(image, k, (y, x), level, &self.distance_m).plane(level);
        let members = self.members(image, k, (y, x), roughly, image.distance_m);
        (members.plane(roughly).middle as f32, members.variance())
    }

    /// For weighted least squares of `values_m` around `known`.
    fn members(
        &self,
        image: Image<'_>,
        k: f64,
        (y, x): (usize, usize),
        known: LocalPlane,
        values_m: &[f32],
    ) -> Members {
        let (height, width) = (image.shape.height, image.shape.width);
        let mut members = Members::default();
        for row in y.saturating_sub(RADIUS)..(y + RADIUS + 1).min(height) {
            let dy = row as f64 - y as f64;
            for column in x.saturating_sub(RADIUS)..(x + RADIUS + 1).min(width) {
                let dx = column as f64 - x as f64;
                let index = row * width + column;
                let plane = known.middle + known.along_x * dx + known.along_y * dy;
                let weight = self.weight(image, k, index, plane);
                if weight > 0.0 {
                    let value = f64::from(values_m[index]);
                    members.moments.add(weight, dx, dy, value - plane);
                    members.widen(value);
                }
            }
        }
        members
    }

    /// `a²`, reduced by the biweight of the guide's distance from the plane; 0 where the pixel does not count.
    fn weight(&self, image: Image<'_>, k: f64, index: usize, plane: f64) -> f64 {
        if image.distance_m[index].is_nan() {
            return 0.0;
        }
        let amplitude = f64::from(image.amplitude[index]);
        let trust = amplitude * amplitude;
        let departure = f64::from(self.distance_m[index]) - plane;
        let detail = f64::from(self.detail[index]);
        let variance = (SMOOTHED_VARIANCE + (1.0 - SMOOTHED_VARIANCE) * detail * detail) * k / trust;
        let ratio = departure * departure / (CUTOFF * CUTOFF * variance);
        if ratio < 1.0 { trust * (1.0 - ratio) * (1.0 - ratio) } else { 0.0 }
    }
}

/// What a plane is fitted to.
#[derive(Clone, Copy, Debug, Default)]
struct Members {
    moments: PlaneMoments,
    /// Least and greatest value.
    range: Option<(f64, f64)>,
}

impl Members {
    fn widen(&mut self, value: f64) {
        let (low, high) = self.range.unwrap_or((value, value));
        self.range = Some((low.min(value), high.max(value)));
    }

    /// Variance in the middle over `k`: that of the mean and, away from it, that of the slopes. The biweight is taken as
    /// part of the inverse variance, which is a little too careful.
    fn variance(&self) -> f64 {
        let tilt = self.moments.variance_of_slopes(LEAST_SPREAD).unwrap_or(0.0);
        CHOSEN_BY_NOISE * (1.0 + tilt) / self.moments.weight()
    }

    /// The known plane corrected by that of the residuals; by their mean alone where the pixels determine no plane.
    /// In the middle it stays within the values that it is fitted to: nothing is extrapolated.
    fn plane(&self, known: LocalPlane) -> LocalPlane {
        let Some((low, high)) = self.range else { return known };
        let level = || LocalPlane { middle: known.middle + self.moments.mean(), ..known };
        let plane = self.moments.corrected(known, LEAST_SPREAD).unwrap_or_else(level);
        LocalPlane { middle: plane.middle.clamp(low, high), ..plane }
    }
}
