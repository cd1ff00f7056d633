//! A label that is flat: one plane for all of its pixels in a frame.
//!
//! The distances of a single window are noisy, and their errors do not average out of a fit. Noise of ln d makes the
//! law too shallow; noise of a normal makes a surface look more tilted than it is, most where it faces the camera, and
//! the exponent of the cosine too large. The plane of a whole board has a hundredth of that variance.

use nalgebra::{Matrix3, Vector3};

use super::measure::WindowMedians;
use super::patches::PATCH_PX;
use crate::frame::{Frame, PixelRays, Plane};
use crate::numerics::robust::Loss;
use crate::numerics::statistics::{SIGMA_PER_MAD, median};

/// Pixels that a plane needs: those of four windows.
const LEAST_PIXELS: usize = 4 * PATCH_PX * PATCH_PX;
/// Windows that show whether the label is flat.
const LEAST_WINDOWS: usize = 4;
/// The windows of a flat label leave the plane by no more than so many times what the noise of their pixels explains.
const EXPECTED_SCALE: f64 = 2.0;
/// Nor matters less than this share of the distance: it moves ln A by a fifth of a percent.
const HARMLESS: f64 = 0.001;
/// Distances whose noise is a smaller share of them give good normals in every window. Those follow the errors that the
/// camera's distances have over the image, as the normals of other scenes will, and a plane does not.
const NOISY: f64 = 0.005;
/// Rounds with Huber's weights, which have one solution, and all.
const START_ROUNDS: usize = 5;
const ROUNDS: usize = 30;
/// Settled when a round moves 1/z by less than this share of it.
const SETTLED: f64 = 1e-6;

/// The plane of a label: `1/s = inverse · r` for a point `s r` on the ray r, so that `inverse` is along the normal. For a
/// ray (x, y, 1), s is the depth; for one of unit length, it is the distance.
#[derive(Clone, Debug)]
pub(super) struct FlatLabel {
    inverse: Vector3<f64>,
    rays: PixelRays,
}

/// One pixel of the label.
struct Pixel {
    ray: Vector3<f64>,
    /// m, radial.
    distance_m: f64,
    /// DN: the noise of a distance is inverse to it (methods, section 1).
    amplitude_dn: f64,
}

impl FlatLabel {
    /// The plane of a label, and whether its windows (first pixels, row and column) lie on it; `None` where they do
    /// not, or there are too few of them to tell.
    pub(super) fn fit(
        frame: &Frame,
        target: &Plane<u8>,
        label: u8,
        windows: &[(usize, usize)],
        rays: &PixelRays,
    ) -> Option<Self> {
        let distance_m = frame.distance_m.as_ref()?;
        let pixel = |index: usize| pixel(frame, distance_m, rays, index);
        let labelled = (0..target.values().len()).filter(|&index| target.values()[index] == label);
        let pixels: Vec<Pixel> = labelled.filter_map(pixel).collect();
        let mine = || windows.iter().filter(|&&(row, column)| target.get(row, column) == Some(label));
        if pixels.len() < LEAST_PIXELS || mine().count() < LEAST_WINDOWS {
            return None;
        }
        let (inverse, scale) = settle(&pixels)?;
        let noise_m = scale / middle(&pixels, |pixel| pixel.amplitude_dn)?;
        if noise_m < NOISY * middle(&pixels, |pixel| pixel.distance_m)? {
            return None;
        }
        let flat = Self { inverse, rays: rays.clone() };
        let mut deviations: Vec<f64> = mine()
            .filter_map(|&(row, column)| {
                let width = target.shape().width;
                let rows = row..row + PATCH_PX;
                let inside =
                    rows.flat_map(|row| (column..column + PATCH_PX).map(move |column| row * width + column));
                flat.deviation(&inside.filter_map(pixel).collect::<Vec<_>>(), scale)
            })
            .collect();
        (median(&mut deviations)? * SIGMA_PER_MAD <= 1.0).then_some(flat)
    }

    /// Gives a window the plane's distance and cosine at its middle; false where its ray does not meet the plane.
    pub(super) fn place(&self, window: &mut WindowMedians) -> bool {
        let [row, column] = window.pixel.map(usize::from);
        let ray = Vector3::from(self.rays.ray(row, column));
        let Some(distance_m) = radial(&self.inverse, &ray) else { return false };
        window.distance_m = distance_m as f32;
        window.cosine = (self.inverse.dot(&ray) / (self.inverse.norm() * ray.norm())).min(1.0) as f32;
        true
    }

    /// How far the median distance of a window is from the plane, over what is allowed.
    fn deviation(&self, pixels: &[Pixel], scale: f64) -> Option<f64> {
        let away = |pixel: &Pixel| Some(pixel.distance_m - radial(&self.inverse, &pixel.ray)?);
        let away_m = median(&mut pixels.iter().filter_map(away).collect::<Vec<_>>())?.abs();
        // A median of n normal values has the standard error 1.25 σ / √n.
        let error_m =
            1.25 * scale / middle(pixels, |pixel| pixel.amplitude_dn)? / (pixels.len() as f64).sqrt();
        Some(away_m / (EXPECTED_SCALE * error_m).max(HARMLESS * middle(pixels, |pixel| pixel.distance_m)?))
    }
}

fn middle(pixels: &[Pixel], of: fn(&Pixel) -> f64) -> Option<f64> {
    median(&mut pixels.iter().map(of).collect::<Vec<_>>())
}

fn pixel(frame: &Frame, distance_m: &Plane<f32>, rays: &PixelRays, index: usize) -> Option<Pixel> {
    let shape = frame.shape();
    let distance_m = f64::from(distance_m.values()[index]);
    let measured = frame.is_valid(index) && distance_m > 0.0 && distance_m.is_finite();
    let (row, column) = shape.place(index);
    let ray = Vector3::from(rays.ray(row, column));
    (measured && !ray.x.is_nan()).then(|| Pixel {
        ray,
        distance_m,
        amplitude_dn: f64::from(frame.amplitude.values()[index]),
    })
}

/// Where a ray meets the plane, m from the camera.
fn radial(inverse: &Vector3<f64>, ray: &Vector3<f64>) -> Option<f64> {
    let per_m = inverse.dot(ray);
    (per_m > 0.0).then(|| ray.norm() / per_m)
}

/// The plane, and the standard deviation of amplitude times distance. The residuals are those of the distances, whose
/// errors are symmetric; those of 1/z are not. Gauss and Newton's steps with robust weights.
fn settle(pixels: &[Pixel]) -> Option<(Vector3<f64>, f64)> {
    let mut inverse = first(pixels)?;
    let mut scale = f64::NAN;
    for round in 0..ROUNDS {
        let residual = |pixel: &Pixel| Some(pixel.distance_m - radial(&inverse, &pixel.ray)?);
        let residuals: Vec<f64> = pixels.iter().map(|pixel| residual(pixel).unwrap_or(f64::NAN)).collect();
        let scaled =
            pixels.iter().zip(&residuals).map(|(pixel, residual)| pixel.amplitude_dn * residual.abs());
        let mut scaled: Vec<f64> = scaled.filter(|scaled| scaled.is_finite()).collect();
        scale = (SIGMA_PER_MAD * median(&mut scaled)?).max(f64::MIN_POSITIVE);
        let (mut normal, mut moment) = (Matrix3::zeros(), Vector3::zeros());
        for (pixel, residual) in pixels.iter().zip(residuals).filter(|(_, residual)| residual.is_finite()) {
            let robust = Loss::Tukey.weight(pixel.amplitude_dn * residual / scale, round < START_ROUNDS);
            let weight = robust * pixel.amplitude_dn * pixel.amplitude_dn;
            let derivative = -pixel.ray * (pixel.ray.norm() / inverse.dot(&pixel.ray).powi(2));
            normal += weight * derivative * derivative.transpose();
            moment += weight * residual * derivative;
        }
        let step = normal.cholesky()?.solve(&moment);
        inverse += step;
        if round >= START_ROUNDS && step.norm() <= SETTLED * inverse.norm() {
            break;
        }
    }
    inverse.iter().all(|value| value.is_finite()).then_some((inverse, scale))
}

/// Linear least squares of the inverse, to start from; the weights are those of the distances at about that of the label.
fn first(pixels: &[Pixel]) -> Option<Vector3<f64>> {
    let (mut normal, mut moment) = (Matrix3::zeros(), Vector3::zeros());
    for pixel in pixels {
        let weight = (pixel.amplitude_dn / pixel.ray.norm()).powi(2);
        normal += weight * pixel.ray * pixel.ray.transpose();
        moment += weight * pixel.ray * (pixel.ray.norm() / pixel.distance_m);
    }
    normal.cholesky().map(|factor| factor.solve(&moment))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::{Intrinsics, Shape};
    use crate::numerics::hash::splitmix64;

    const SHAPE: Shape = Shape::new(60, 80);
    const INTRINSICS: Intrinsics = Intrinsics { fx: 90.0, fy: 90.0, cx: 39.5, cy: 29.5 };
    /// Standard deviation of a distance: a phase of a signal-to-noise ratio of 10 at 20 MHz.
    const NOISE_M: f64 = 0.12;

    /// Twelve uniform numbers make a normal one.
    fn normal(index: usize, seed: u64) -> f64 {
        let uniform = |part: u64| {
            (splitmix64(seed << 32 | (12 * index as u64 + part)) >> 11) as f64 / (1u64 << 53) as f64
        };
        (0..12).map(uniform).sum::<f64>() - 6.0
    }

    /// A frame whose label 1 is everywhere, at radial distances `of` the pixels' rays.
    fn frame(of: impl Fn(&Vector3<f64>) -> f64, noise_m: f64, seed: u64) -> (Frame, Plane<u8>) {
        let mut frame = Frame::new(SHAPE);
        frame.amplitude.fill(100.0);
        let distance = |row: usize, column: usize| {
            let ray = Vector3::from(INTRINSICS.ray(row as f64, column as f64));
            (of(&ray) + noise_m * normal(row * SHAPE.width + column, seed)) as f32
        };
        frame.distance_m = Some(Plane::from_fn(SHAPE, distance));
        frame.flag_amplitude(None);
        (frame, Plane::filled(SHAPE, 1))
    }

    /// All that do not overlap: so many that chance hardly ever takes them off their plane.
    fn windows() -> Vec<(usize, usize)> {
        let rows = (0..SHAPE.height / PATCH_PX).map(|row| row * PATCH_PX);
        rows.flat_map(|row| (0..SHAPE.width / PATCH_PX).map(move |column| (row, column * PATCH_PX))).collect()
    }

    fn window() -> WindowMedians {
        WindowMedians {
            frame: 0,
            label: 1,
            time_us: 1000.0,
            ln_amplitude: 100f32.ln(),
            distance_m: f32::NAN,
            measured_m: f32::NAN,
            pixel: [12, 60],
            cosine: f32::NAN,
            scatter: 0.1,
            pixels: 25,
        }
    }

    #[test]
    fn the_plane_of_noisy_distances_has_no_bias() {
        for inverse in [Vector3::new(0.0, 0.0, 0.5), Vector3::new(0.4, -0.3, 0.5)] {
            let (mut found_m, mut found_cosine) = (0.0, 0.0);
            for seed in 0..10 {
                let of = |ray: &Vector3<f64>| radial(&inverse, ray).unwrap();
                let (frame, target) = frame(of, NOISE_M, seed);
                let plane =
                    FlatLabel::fit(&frame, &target, 1, &windows(), &PixelRays::Pinhole(INTRINSICS)).unwrap();
                let mut window = window();
                assert!(plane.place(&mut window));
                found_m += 0.1 * f64::from(window.distance_m);
                found_cosine += 0.1 * f64::from(window.cosine);
            }
            let ray = Vector3::from(INTRINSICS.ray(12.0, 60.0));
            let distance_m = radial(&inverse, &ray).unwrap();
            let cosine = inverse.dot(&ray) / (inverse.norm() * ray.norm());
            // 4800 pixels, three unknowns, ten frames: σ √(3/48000), and four of these. Slopes: the image spans half a
            // radian to either side, so that theirs is √3 / 0.4 times as large, in units of the distance.
            let error_m = 4.0 * NOISE_M * (3.0f64 / 48_000.0).sqrt();
            assert!((found_m - distance_m).abs() < error_m, "{found_m} {distance_m}");
            let error = error_m * 3f64.sqrt() / (0.4 * distance_m);
            assert!((found_cosine - cosine).abs() < error, "{found_cosine} {cosine}");
        }
    }

    #[test]
    fn what_is_bent_has_no_plane() {
        // A ball of 0.5 m radius at 1.5 m.
        let ball = |ray: &Vector3<f64>| {
            let unit = ray.normalize();
            let along = 1.5 * unit[2];
            along - (along * along - 1.5 * 1.5 + 0.25).max(0.0).sqrt()
        };
        let (bent, target) = frame(ball, 0.002, 1);
        assert!(FlatLabel::fit(&bent, &target, 1, &windows(), &PixelRays::Pinhole(INTRINSICS)).is_none());
        assert!(
            FlatLabel::fit(&bent, &target, 2, &windows(), &PixelRays::Pinhole(INTRINSICS)).is_none(),
            "not in sight"
        );
    }
}
