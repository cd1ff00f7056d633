//! The angle of incidence of each pixel of a frame, from its denoised distances.

use super::neighbourhood::inverse_scale;
use super::normals::Field;
use crate::denoise::{DenoiseRule, Denoiser};
use crate::frame::{Frame, PixelRays, Plane, Shape};
use crate::memory::bytes;

/// Denoises a frame's distances and fits the planes; reuse one for a whole recording. Empty until it is used.
#[derive(Clone, Debug, Default)]
pub(crate) struct Incidence {
    denoiser: Denoiser,
    normals: Normals,
}

impl Incidence {
    /// Bytes that it holds.
    pub(crate) fn bytes(&self) -> usize {
        self.denoiser.bytes() + self.normals.bytes()
    }

    /// Takes the next frame, seen at `distance_m` (m, radial) along `rays` of its shape. Allocates only when the shape differs from that of the
    /// last frame.
    pub(crate) fn take(&mut self, frame: &Frame, distance_m: &Plane<f32>, rays: &PixelRays) {
        self.denoiser.denoise(DenoiseRule::Wiener, frame, distance_m, false);
        let (denoised_m, scale) = self.denoiser.wiener_result();
        self.normals.take(frame, rays, denoised_m, scale.sqrt());
    }

    /// Cosine of the angle of incidence, 0..=1, at a pixel of that frame; NaN where no plane was found or the pixel
    /// is no measurement.
    pub(crate) fn cosine(&self, index: usize, rays: &PixelRays) -> f32 {
        self.normals.cosine(index, rays)
    }

    /// Cosines of all pixels of a frame, row by row.
    pub(crate) fn cosines(&mut self, frame: &Frame, distance_m: &Plane<f32>, rays: &PixelRays) -> &[f32] {
        self.take(frame, distance_m, rays);
        self.normals.cosines(rays)
    }
}

/// Working memory of the fits.
#[derive(Clone, Debug)]
struct Normals {
    shape: Shape,
    /// Inverse depth, 1/m, in the axes that each pixel is laid out in; NaN where there is no distance.
    inverse_depth: Vec<f32>,
    /// Relative standard deviation of each pixel's distance, before it was denoised.
    noise: Vec<f32>,
    cosines: Vec<f32>,
}

impl Default for Normals {
    fn default() -> Self {
        let empty = Vec::new;
        Self { shape: Shape::new(0, 0), inverse_depth: empty(), noise: empty(), cosines: empty() }
    }
}

impl Normals {
    fn bytes(&self) -> usize {
        [&self.inverse_depth, &self.noise, &self.cosines].map(bytes).iter().sum()
    }

    /// `distance_m` are denoised radial distances (m), NaN or not positive where there are none; before that, they had
    /// the standard deviation `deviation / amplitude`.
    fn take(&mut self, frame: &Frame, rays: &PixelRays, distance_m: &[f32], deviation: f64) {
        self.shape = frame.shape();
        self.inverse_depth.resize(distance_m.len(), f32::NAN);
        self.noise.resize(distance_m.len(), f32::NAN);
        for (index, &distance) in distance_m.iter().enumerate() {
            let per_depth = inverse_scale(rays, self.shape, index);
            let measured = distance > 0.0 && distance < f32::INFINITY && frame.is_valid(index);
            let inverse = if measured { (per_depth / f64::from(distance)) as f32 } else { f32::NAN };
            self.inverse_depth[index] = inverse;
            self.noise[index] = deviation as f32 / (frame.amplitude.values()[index] * distance);
        }
    }

    fn cosine(&self, index: usize, rays: &PixelRays) -> f32 {
        if self.inverse_depth[index].is_nan() {
            return f32::NAN;
        }
        let field = Field { shape: self.shape, rays, inverse_depth: &self.inverse_depth };
        let cosine = field.cosine(index, f64::from(self.noise[index]));
        cosine.map_or(f32::NAN, |cosine| cosine as f32)
    }

    fn cosines(&mut self, rays: &PixelRays) -> &[f32] {
        let mut cosines = std::mem::take(&mut self.cosines);
        cosines.resize(self.inverse_depth.len(), f32::NAN);
        cosines.iter_mut().enumerate().for_each(|(index, out)| *out = self.cosine(index, rays));
        self.cosines = cosines;
        &self.cosines
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::frame::{Distortion, Intrinsics, Lens, RayTable, SpinningLidar};
    use crate::surface::neighbourhood::radial_per_depth;

    const SHAPE: Shape = Shape::new(60, 80);
    const INTRINSICS: Intrinsics = Intrinsics { fx: 90.0, fy: 92.0, cx: 38.0, cy: 31.0 };

    /// Radial distance and cosine of the plane `n · p = offset` at a pixel.
    fn plane(n: [f64; 3], offset: f64, index: usize) -> (f64, f64) {
        let ray = INTRINSICS.ray((index / SHAPE.width) as f64, (index % SHAPE.width) as f64);
        let dot = n[0] * ray[0] + n[1] * ray[1] + n[2] * ray[2];
        let length = radial_per_depth(&INTRINSICS, SHAPE.place(index));
        let size = (n[0] * n[0] + n[1] * n[1] + n[2] * n[2]).sqrt();
        (offset / dot * length, dot / (length * size))
    }

    fn uniform(state: &mut u64) -> f64 {
        *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (*state >> 11) as f64 / (1u64 << 53) as f64 - 0.5
    }

    /// Cosines where the distances have the standard deviation `noise_m`.
    fn cosines(shape: Shape, distance_m: &[f32], noise_m: f64) -> Vec<f32> {
        cosines_along(&PixelRays::Pinhole(INTRINSICS), shape, distance_m, noise_m)
    }

    fn cosines_along(rays: &PixelRays, shape: Shape, distance_m: &[f32], noise_m: f64) -> Vec<f32> {
        let mut frame = Frame::new(shape);
        frame.amplitude.fill(100.0);
        let mut normals = Normals::default();
        normals.take(&frame, rays, distance_m, 100.0 * noise_m);
        normals.cosines(rays).to_vec()
    }

    #[test]
    fn the_angle_of_any_plane_is_exact_up_to_the_edges() {
        for n in [[0.0, 0.0, 1.0], [0.8, 0.1, 1.0], [-0.5, 1.1, 1.0]] {
            let truth: Vec<(f64, f64)> = (0..SHAPE.pixels()).map(|i| plane(n, 1.3, i)).collect();
            let distances: Vec<f32> = truth.iter().map(|(d, _)| *d as f32).collect();
            let cosines = cosines(SHAPE, &distances, 0.0);
            for (found, (d, cosine)) in cosines.iter().zip(&truth) {
                // 1/z in f32, 6e-8 of it, over a window of 1/25 rad: 2e-6 of slant. Beyond 68° nothing is promised.
                assert!(
                    *d <= 0.0 || *cosine < 0.37 || (f64::from(*found) - cosine).abs() < 1e-4,
                    "{found} {cosine}"
                );
            }
        }
    }

    #[test]
    fn a_step_of_depth_bends_no_normal_on_either_side() {
        let side = |index: usize| {
            if index % SHAPE.width < 40 { ([0.5, 0.0, 1.0], 1.0) } else { ([0.0, -0.4, 1.0], 1.6) }
        };
        let mut state = 5;
        let truth: Vec<(f64, f64)> = (0..SHAPE.pixels()).map(|i| plane(side(i).0, side(i).1, i)).collect();
        let distances: Vec<f32> =
            truth.iter().map(|(d, _)| (d * (1.0 + 0.002 * uniform(&mut state))) as f32).collect();
        let cosines = cosines(SHAPE, &distances, 0.0006);
        let errors =
            cosines.iter().zip(&truth).map(|(found, (_, cosine))| (f64::from(*found) - cosine).abs());
        let errors: Vec<f64> = errors.filter(|error| error.is_finite()).collect();
        // σ = 0.06 %: a slant error of σ √3 f / (R √81) = 0.3 mrad·… below 1e-2 at any angle; half the window may be
        // missing at the edge, which triples it.
        let bad = errors.iter().filter(|error| **error > 0.03).count();
        assert!(errors.len() > SHAPE.pixels() * 99 / 100, "{}", errors.len());
        assert!(bad * 200 < errors.len(), "{bad} of {}", errors.len());
    }

    #[test]
    fn pixels_without_a_surface_have_no_angle() {
        let mut distances = vec![f32::NAN; SHAPE.pixels()];
        distances[40] = 1.0;
        (0..80).for_each(|column| distances[30 * 80 + column] = 1.0);
        // One pixel and one line determine no plane.
        assert!(cosines(SHAPE, &distances, 0.0).iter().all(|c| c.is_nan()));
        assert!(cosines(Shape::new(1, 1), &[1.0], 0.0)[0].is_nan());
    }

    /// What `lens` sees of the plane `n · p = offset`: radial distance and cosine.
    fn seen(lens: &Lens, shape: Shape, n: [f64; 3], offset: f64) -> Vec<(f64, f64)> {
        let at = |index: usize| {
            let (row, column) = shape.place(index);
            let ray = lens.ray(shape, row, column).unwrap_or([f64::NAN; 3]);
            let length = |v: [f64; 3]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
            let dot = n.iter().zip(ray).map(|(n, r)| n * r).sum::<f64>() / length(ray);
            (offset / dot, dot / length(n))
        };
        (0..shape.pixels()).map(at).collect()
    }

    fn expect_angles(lens: &Lens, shape: Shape, n: [f64; 3], least_cosine: f64) -> usize {
        let truth = seen(lens, shape, n, 1.3);
        let distances: Vec<f32> =
            truth.iter().map(|(d, _)| if *d > 0.0 { *d as f32 } else { f32::NAN }).collect();
        let found = cosines_along(&lens.pixel_rays(shape), shape, &distances, 0.0);
        let mut checked = 0;
        for (found, (d, cosine)) in found.iter().zip(&truth) {
            if *d > 0.0 && *cosine > least_cosine {
                // As of a pinhole; a lidar's beams are up to 2° apart, which the fit of a plane does not mind.
                assert!((f64::from(*found) - cosine).abs() < 1e-4, "{lens}: {found} {cosine}");
                checked += 1;
            }
        }
        checked
    }

    #[test]
    fn the_angle_of_a_plane_is_exact_behind_any_lens() {
        let wide = Intrinsics { fx: 30.0, fy: 31.0, cx: 38.0, cy: 31.0 };
        let distorted =
            |name: &str, k: &[f64]| Lens::Distorted(wide, Distortion::named(name, k).unwrap().unwrap());
        let lenses = [
            Lens::Pinhole(wide),
            distorted("fisheye", &[0.01, -0.002, 0.0, 0.0]),
            distorted("brown_conrady", &[-0.05, 0.002, 0.001, -0.002, 0.0]),
        ];
        for lens in lenses {
            let table = Lens::Rays(Arc::new(table_of(&lens)));
            for n in [[0.0, 0.0, 1.0], [0.8, 0.1, 1.0], [-0.5, 1.1, 1.0]] {
                for lens in [&lens, &table] {
                    let checked = expect_angles(lens, SHAPE, n, 0.37);
                    assert!(checked > SHAPE.pixels() / 3, "{lens}: {checked}");
                }
            }
        }
        // To the side and behind, where no pinhole looks.
        let fisheye = distorted("fisheye", &[0.0; 4]);
        assert!(expect_angles(&fisheye, SHAPE, [1.0, 0.0, -0.2], 0.37) > SHAPE.pixels() / 5);
    }

    fn table_of(lens: &Lens) -> RayTable {
        let ray = |index: usize| {
            let (row, column) = SHAPE.place(index);
            lens.ray(SHAPE, row, column).unwrap_or([f64::NAN; 3]).map(|value| 0.5 * value)
        };
        RayTable::new(SHAPE, &(0..SHAPE.pixels()).flat_map(ray).collect::<Vec<_>>()).unwrap()
    }

    #[test]
    fn a_road_before_a_spinning_lidar_has_its_angle_to_80_degrees_all_around() {
        let altitudes: Vec<f64> = (0..32).map(|row| 15.0 - 1.4 * f64::from(row)).collect();
        let lidar = Lens::Spinning(Arc::new(SpinningLidar::new(&altitudes, &[]).unwrap()));
        let shape = Shape::new(32, 256);
        // Beams lower than 10° below the horizon: the last 14.
        let checked = expect_angles(&lidar, shape, [0.0, 0.0, -1.0], 0.17);
        assert_eq!(checked, 14 * 256);
    }
}
