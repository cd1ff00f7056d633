//! Is a flat target flat? With the wrong intrinsics it is not.

use std::collections::BTreeMap;

use nalgebra::{Matrix3, Vector3};

use super::sweep::TargetWindows;
use crate::frame::{Lens, Shape};
use crate::numerics::statistics::median;

/// A target that the intrinsics make curved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Curved {
    /// Deviation from a plane, root mean square, m.
    pub(super) deviation_m: f64,
    /// With the focal lengths times this factor, it would be flat.
    pub(super) focal_factor: f64,
}

/// Factors on the focal lengths that are tried besides 1. An error of less than 15 % bends a target by less than the
/// distances scatter.
const FACTORS: [f64; 10] = [0.4, 0.5, 0.6, 0.7, 0.85, 1.15, 1.4, 1.7, 2.0, 2.5];
/// Windows of one label in one frame that are compared with a plane.
const LEAST_WINDOWS: usize = 20;
/// With another factor, half of the faces must be flatter by this factor: with the right one, they are as flat as the
/// distances' noise allows, which hundreds of windows tell to a few per cent.
const FLATTER: f64 = 1.25;

/// Row, column and distance (m) of a window.
type Point = (usize, usize, f64);

/// Whether the targets of a recording are flat with other focal lengths and curved with its own. A curved target is
/// curved with all of them. A lens without focal lengths is taken at its word.
pub(super) fn curved(target: &TargetWindows) -> Option<Curved> {
    let (lens, shape) = (target.lens.as_ref()?, target.shape?);
    lens.scaled(1.0)?;
    let mut faces: BTreeMap<(u32, u8), Vec<Point>> = BTreeMap::new();
    for window in target.windows.iter().filter(|window| window.measured_m > 0.0) {
        let [row, column] = window.pixel.map(usize::from);
        let face = faces.entry((window.frame, window.label)).or_default();
        face.push((row, column, f64::from(window.measured_m)));
    }
    faces.retain(|_, face| face.len() >= LEAST_WINDOWS);
    let deviations = |factor: f64| -> Vec<f64> {
        let Some(scaled) = lens.scaled(factor) else { return Vec::new() };
        faces.values().map(|face| from_plane(face, &scaled, shape)).collect()
    };
    let own = deviations(1.0);
    let flatter = |factor: f64| {
        let mut ratios: Vec<f64> = own.iter().zip(deviations(factor)).map(|(own, with)| own / with).collect();
        Some((factor, median(&mut ratios)?))
    };
    let known = FACTORS.into_iter().filter_map(flatter).filter(|(_, flatter)| !flatter.is_nan());
    let best = known.max_by(|a, b| a.1.total_cmp(&b.1));
    let (focal_factor, _) = best.filter(|(_, flatter)| *flatter > FLATTER)?;
    Some(Curved { deviation_m: median(&mut own.clone())?, focal_factor })
}

/// Root mean square deviation, along the rays, of points (row, column, distance) from the plane that fits them best, m.
/// On a plane, 1/d is linear in the direction of the ray. Distances across the plane would do no good: with long focal
/// lengths, all planes that hold the line of sight fit.
fn from_plane(face: &[Point], lens: &Lens, shape: Shape) -> f64 {
    // Scaled, the image may reach beyond the domain of a distortion: then the deviation is NaN, and not the least.
    let ray = |row: usize, column: usize| {
        Vector3::from(lens.ray(shape, row, column).unwrap_or([f64::NAN; 3])).normalize()
    };
    let (mut gram, mut moment, mut sum_m) = (Matrix3::zeros(), Vector3::zeros(), 0.0);
    for &(row, column, distance_m) in face {
        // Errors are relative: 1/d, times d, is 1.
        let scaled = ray(row, column) * distance_m;
        gram += scaled * scaled.transpose();
        moment += scaled;
        sum_m += distance_m;
    }
    let Some(inverse) = gram.try_inverse() else { return f64::NAN };
    let plane = inverse * moment;
    let deviation =
        |&(row, column, distance_m): &(usize, usize, f64)| 1.0 - plane.dot(&ray(row, column)) * distance_m;
    let squares = face.iter().map(|place| deviation(place).powi(2));
    let count = face.len() as f64;
    sum_m / count * (squares.sum::<f64>() / count).sqrt()
}
