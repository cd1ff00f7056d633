//! A label that is flat: one plane for all of its pixels in a frame.
//!
//! The distances of a single window are noisy, and their errors do not average out of a fit. Noise of ln d makes the
//! law too shallow; noise of a normal makes a surface look more tilted than it is, most where it faces the camera, and
//! the exponent of the cosine too large. The plane of a whole board has a hundredth of that variance.

use nalgebra::{Matrix3, Vector3};

use super::measure::WindowMedians;
use super::patches::PATCH_PX;
use crate::frame::{Frame, Intrinsics, Plane};
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
/// Rounds with Huber's weights, which have one solution, and all.
const START_ROUNDS: usize = 5;
const ROUNDS: usize = 30;
/// Settled when a round moves 1/z by less than this share of it.
const SETTLED: f64 = 1e-6;

/// The plane of a label: `1/z = inverse · (x, y, 1)` for the ray (x, y, 1), so that `inverse` is along the normal.
#[derive(Clone, Copy, Debug)]
pub(super) struct FlatLabel {
    inverse: Vector3<f64>,
    intrinsics: Intrinsics,
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
        intrinsics: &Intrinsics,
    ) -> Option<Self> {
        let distance_m = frame.distance_m.as_ref()?;
        let pixel = |index: usize| pixel(frame, distance_m, intrinsics, index);
        let labelled = (0..target.values().len()).filter(|&index| target.values()[index] == label);
        let pixels: Vec<Pixel> = labelled.filter_map(pixel).collect();
        let mine = || windows.iter().filter(|&&(row, column)| target.get(row, column) == Some(label));
        if pixels.len() < LEAST_PIXELS || mine().count() < LEAST_WINDOWS {
            return None;
        }
        let (inverse, scale) = settle(&pixels)?;
        let flat = Self { inverse, intrinsics: *intrinsics };
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
        let [row, column] = window.pixel.map(f64::from);
        let ray = Vector3::from(self.intrinsics.ray(row, column));
        let Some(distance_m) = radial(&self.inverse, &ray) else { return false };
        window.distance_m = distance_m as f32;
        window.cosine = (self.inverse.dot(&ray) / (self.inverse.norm() * ray.norm())).min(1.0) as f32;
        true
    }

    /// How far the median distance of a window is from the plane, over what is allowed.
    fn deviation(&self, pixels: &[Pixel], scale: f64) -> Option<f64> {
        let middle = |of: fn(&Pixel) -> f64| median(&mut pixels.iter().map(of).collect::<Vec<_>>());
        let away = |pixel: &Pixel| Some(pixel.distance_m - radial(&self.inverse, &pixel.ray)?);
        let away_m = median(&mut pixels.iter().filter_map(away).collect::<Vec<_>>())?.abs();
        // A median of n normal values has the standard error 1.25 σ / √n.
        let error_m = 1.25 * scale / middle(|pixel| pixel.amplitude_dn)? / (pixels.len() as f64).sqrt();
        Some(away_m / (EXPECTED_SCALE * error_m).max(HARMLESS * middle(|pixel| pixel.distance_m)?))
    }
}

fn pixel(frame: &Frame, distance_m: &Plane<f32>, intrinsics: &Intrinsics, index: usize) -> Option<Pixel> {
    let shape = frame.shape();
    let distance_m = f64::from(distance_m.values()[index]);
    let measured = frame.is_valid(index) && distance_m > 0.0 && distance_m.is_finite();
    let (row, column) = shape.place(index);
    measured.then(|| Pixel {
        ray: Vector3::from(intrinsics.ray(row as f64, column as f64)),
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

/// Linear least squares of 1/z, to start from; the weights are those of the distances at about that of the label.
fn first(pixels: &[Pixel]) -> Option<Vector3<f64>> {
    let (mut normal, mut moment) = (Matrix3::zeros(), Vector3::zeros());
    for pixel in pixels {
        let weight = (pixel.amplitude_dn / pixel.ray.norm()).powi(2);
        normal += weight * pixel.ray * pixel.ray.transpose();
        moment += weight * pixel.ray * (pixel.ray.norm() / pixel.distance_m);
    }
    normal.cholesky().map(|factor| factor.solve(&moment))
}
