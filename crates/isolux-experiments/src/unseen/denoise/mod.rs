//! What denoising the distance is worth, and what it may not do: flat areas, bars of three pixels, a checkerboard at one
//! distance, all at a signal-to-noise ratio of 4.5.

mod frames;

use isolux::{DenoiseRule, Intrinsics};
use isolux_camera::SimulatedFrame;
use isolux_camera::scene::object::{Form, Object};
use isolux_camera::scene::texture::Texture;

use crate::error::ExperimentError;
use crate::measure::coefficient_of_variation;
use frames::{Scaled, counted, mean};
pub use frames::{at_snr, camera};

/// Every rule.
pub const RULES: [DenoiseRule; 4] =
    [DenoiseRule::Median, DenoiseRule::Wiener, DenoiseRule::Plane, DenoiseRule::Temporal];
/// Distance of the flat areas and of the bars, m.
const NEAR_M: f64 = 2.45;

/// Pixels far enough from the image's edge for every window.
#[must_use]
pub fn inner(row: usize, column: usize) -> bool {
    (12..132).contains(&row) && (12..164).contains(&column)
}

/// A ball around the camera: the same distance everywhere.
#[must_use]
pub fn surrounding(texture: Texture) -> Object {
    Object::new("ball", Form::Sphere { radius_m: NEAR_M }, [0.0; 3], texture)
}

/// A wall that fills the image.
#[must_use]
pub fn wall(depth_m: f64, texture: Texture) -> Object {
    Object::new("wall", Form::Rectangle { size_m: [100.0, 100.0] }, [0.0, 0.0, depth_m], texture)
}

/// Noise of the scaled amplitude on a flat area over that with the true distance; `None` denoises nothing:
/// `√(1 + (2/φ)²)` in theory.
///
/// # Errors
/// [`ExperimentError`], which no seed should bring about.
pub fn flat_noise(rules: &[Option<DenoiseRule>]) -> Result<Vec<f64>, ExperimentError> {
    let frames = at_snr(&[surrounding(Texture::Uniform(0.5))], inner)?;
    let noise = |scaled: &Scaled| {
        let cvs: Vec<f64> =
            scaled.planes.iter().map(|plane| coefficient_of_variation(&counted(plane, inner))).collect();
        mean(&cvs)
    };
    let floor = noise(&Scaled::perfect(&frames)?);
    rules.iter().map(|rule| Ok(noise(&Scaled::new(&frames, *rule)?) / floor)).collect()
}

/// Bars of 3 pixels before a wall.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bars {
    /// Depth of the wall; the bars are at 2.45 m.
    pub wall_m: f64,
    /// The wall returns the amplitude of the bars, so that their contours cannot be seen in it; otherwise it is of
    /// the same material.
    pub equal_amplitude: bool,
}

impl Bars {
    /// Depth between bar and wall, m.
    #[must_use]
    pub fn step_m(self) -> f64 {
        self.wall_m - NEAR_M
    }

    /// Mean scaled amplitude on the bars over that with the true distance, less 1.
    ///
    /// # Errors
    /// [`ExperimentError`], which no seed should bring about.
    pub fn bias(self, rules: &[Option<DenoiseRule>]) -> Result<Vec<f64>, ExperimentError> {
        let on_bar =
            |row, column| inner(row, column) && (20..156).contains(&column) && (column - 20) % 16 < 3;
        let frames = at_snr(&self.objects()?, on_bar)?;
        let truth = Scaled::perfect(&frames)?.mean(on_bar);
        rules.iter().map(|rule| Ok(Scaled::new(&frames, *rule)?.mean(on_bar) / truth - 1.0)).collect()
    }

    fn objects(self) -> Result<Vec<Object>, ExperimentError> {
        const WHITE: f64 = 0.9;
        let Intrinsics { fx, cx, .. } = camera()?.intrinsics;
        let reflectivity = if self.equal_amplitude { WHITE * (NEAR_M / self.wall_m).powi(2) } else { WHITE };
        let bar = |left: usize| {
            let x = (left as f64 + 1.0 - cx) * NEAR_M / fx;
            let form = Form::Rectangle { size_m: [3.0 * NEAR_M / fx, 100.0] };
            Object::new(&format!("bar {left}"), form, [x, 0.0, NEAR_M], Texture::Uniform(reflectivity))
        };
        let mut objects = vec![wall(self.wall_m, Texture::Uniform(WHITE))];
        objects.extend((20..156).step_by(16).map(bar));
        Ok(objects)
    }
}

/// Mean departure of the denoised distance from the true one in the pixels that count, m.
///
/// # Errors
/// [`ExperimentError`], which no seed should bring about.
pub fn distance_bias_m(
    frames: &[SimulatedFrame],
    rule: DenoiseRule,
    counts: impl Fn(usize, usize) -> bool + Copy,
) -> Result<f64, ExperimentError> {
    let scaled = Scaled::new(frames, Some(rule))?;
    let biases: Vec<f64> = scaled
        .used_distances(frames)
        .map(|(used, truth)| mean(&counted(&used, counts)) - mean(&counted(truth, counts)))
        .collect();
    Ok(mean(&biases))
}

/// A checkerboard at one distance: what its bright squares get of the distance more than its dark ones, m.
///
/// # Errors
/// [`ExperimentError`], which no seed should bring about.
pub fn texture_leak_m(rules: &[DenoiseRule]) -> Result<Vec<f64>, ExperimentError> {
    let texture = Texture::Checkerboard { cell_m: 0.1, reflectivities: [0.5, 0.9] };
    let frames = at_snr(&[surrounding(texture)], inner)?;
    let reflectivity = &frames[0].truth.reflectivity;
    let is_bright = |row, column| reflectivity.get(row, column).is_some_and(|value| value > 0.7);
    let leak = |rule: &DenoiseRule| {
        let bright =
            distance_bias_m(&frames, *rule, |row, column| inner(row, column) && is_bright(row, column))?;
        let dark =
            distance_bias_m(&frames, *rule, |row, column| inner(row, column) && !is_bright(row, column))?;
        Ok(bright - dark)
    };
    rules.iter().map(leak).collect()
}
