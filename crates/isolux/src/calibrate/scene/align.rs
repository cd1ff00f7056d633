//! Estimates the pose of a view from the known surfaces: robust projective point-to-plane alignment (Chen and
//! Medioni 1991; Rusinkiewicz and Levoy 2001), which is checked before it is used.

use nalgebra::{Matrix6, Vector3, Vector6};

use super::rigid::Rigid;
use super::surfaces::{SAME_NORMAL, Surface, Surfaces};
use super::view::View;
use crate::numerics::robust::Loss;
use crate::numerics::statistics::{SIGMA_PER_MAD, median_absolute_deviation};

const ITERATIONS: usize = 60;
/// Iterations in which surfaces farther than the expected error are still drawn near.
const COARSE_ITERATIONS: usize = 20;
/// Farthest from its plane that a point may be at first, and by what the limit shrinks with each iteration.
const FIRST_GATE_M: f64 = 0.3;
const GATE_SHRINKS: f64 = 0.85;
/// Settled when a step moves no point by more than this share of its error.
const SETTLED: f64 = 0.02;
/// Normals with a larger standard error (rad) are not used.
const LARGEST_NORMAL_ERROR: f64 = 0.25;
/// Least number of common surfaces for an alignment.
const LEAST_SURFACES: usize = 60;
/// The facets of neighbouring pixels share their windows, and a scene is not made of planes alone.
const EXPECTED_SCALE: f64 = 5.0;
/// Share of the common surfaces that must agree.
const LEAST_AGREEING: f64 = 0.5;
/// Least hold: the root mean square of the surfaces' resistance to the motion that they resist least (1 where all
/// face it), without the part that the noise of the normals adds. The hold of a single plane is 0 within some
/// hundredths.
const LEAST_HOLD: f64 = 0.03;

/// Why the pose of a view could not be estimated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Lost {
    /// Too few known surfaces in sight.
    Unknown { surfaces: usize },
    /// The surfaces let the camera slide: a plane, a corridor, a ball.
    Slides { hold: f64 },
    /// The surfaces contradict each other.
    Disagrees { scale: f64, agreeing: f64 },
}

/// A view's place.
#[derive(Clone, Copy, Debug)]
pub(super) struct Aligned {
    pub(super) world_from_camera: Rigid,
    /// Scatter of the points about their planes, in expected standard errors.
    pub(super) scale: f64,
}

/// One known surface in the view.
struct Pair {
    /// The view's point, world coordinates of the present pose.
    point_m: Vector3<f64>,
    normal: Vector3<f64>,
    /// Distance from the plane, in standard errors, and the error (m).
    standardized: f64,
    error_m: f64,
    normal_error: f64,
}

/// Aligns `view`, starting from each of the `guesses` until a pose passes the checks.
pub(super) fn align(surfaces: &Surfaces, view: &View, guesses: &[Rigid]) -> Result<Aligned, Lost> {
    let mut outcome = Err(Lost::Unknown { surfaces: 0 });
    for guess in guesses {
        outcome = from_guess(surfaces, view, *guess);
        if outcome.is_ok() {
            break;
        }
    }
    outcome
}

fn from_guess(surfaces: &Surfaces, view: &View, guess: Rigid) -> Result<Aligned, Lost> {
    let (mut pose, mut gate_m) = (guess, FIRST_GATE_M);
    for iteration in 0..ITERATIONS {
        let (pairs, _) = pairs(surfaces, view, &pose, gate_m);
        if pairs.len() < LEAST_SURFACES {
            return Err(Lost::Unknown { surfaces: pairs.len() });
        }
        let scale = scale(&pairs);
        let centre = centre(&pairs);
        let (normal, moment, _) = normal_equations(&pairs, &centre, scale);
        let Some(factor) = normal.cholesky() else { return Err(Lost::Slides { hold: 0.0 }) };
        let step: Vector6<f64> = -factor.solve(&moment);
        pose = turned_about(&centre, &Rigid::small(&step)).after(&pose);
        gate_m *= GATE_SHRINKS;
        let moved_m =
            step.fixed_rows::<3>(0).norm() * lever(&pairs, &centre) + step.fixed_rows::<3>(3).norm();
        let error_m = pairs.iter().map(|pair| pair.error_m).sum::<f64>() / pairs.len() as f64;
        if iteration >= COARSE_ITERATIONS && moved_m <= SETTLED * error_m {
            break;
        }
    }
    believe(surfaces, view, pose)
}

/// Checks a pose, with the widest gate, so that contradicting surfaces count.
fn believe(surfaces: &Surfaces, view: &View, pose: Rigid) -> Result<Aligned, Lost> {
    let (pairs, unlike) = pairs(surfaces, view, &pose, FIRST_GATE_M);
    if pairs.len() < LEAST_SURFACES {
        return Err(Lost::Unknown { surfaces: pairs.len() });
    }
    let (scale, centre) = (scale(&pairs), centre(&pairs));
    let (normal, _, total) = normal_equations(&pairs, &centre, scale);
    let lever_m = lever(&pairs, &centre);
    let units = Vector6::new(lever_m, lever_m, lever_m, 1.0, 1.0, 1.0);
    let share = Matrix6::from_fn(|i, j| normal[(i, j)] / (units[i] * units[j] * total));
    let feigned = pairs.iter().map(|pair| (pair.normal_error / pair.error_m).powi(2)).sum::<f64>() / total;
    let hold = (share.symmetric_eigenvalues().min() - feigned).max(0.0).sqrt();
    if hold < LEAST_HOLD {
        return Err(Lost::Slides { hold });
    }
    let limit = EXPECTED_SCALE * scale.max(1.0);
    let agreeing = pairs.iter().filter(|pair| pair.standardized.abs() <= limit).count() as f64;
    let agreeing = agreeing / (pairs.len() + unlike) as f64;
    if scale > EXPECTED_SCALE || agreeing < LEAST_AGREEING {
        return Err(Lost::Disagrees { scale, agreeing });
    }
    Ok(Aligned { world_from_camera: pose, scale })
}

/// Known surfaces and what the view has in their places; how many others are in sight where it has something else.
fn pairs(surfaces: &Surfaces, view: &View, pose: &Rigid, gate_m: f64) -> (Vec<Pair>, usize) {
    let camera = pose.inverse();
    let mut unlike = 0;
    let pair = |surface: &Surface| {
        if surface.normal_error() > LARGEST_NORMAL_ERROR {
            return None;
        }
        let (place_m, normal) = (surface.point_m(), surface.normal());
        let facet = view.facet(view.pixel_of(&camera.point(&place_m))?)?;
        let point_m = pose.point(&facet.point_m);
        let away_m = normal.dot(&(point_m - place_m));
        let error_m = facet.error_m.hypot(surface.error_m());
        let like = (pose.rotation * facet.normal).dot(&normal) >= SAME_NORMAL;
        if !like || away_m.abs() > gate_m.max(4.0 * error_m) {
            unlike += 1;
            return None;
        }
        let normal_error = surface.normal_error();
        Some(Pair { point_m, normal, standardized: away_m / error_m, error_m, normal_error })
    };
    (surfaces.surfaces.iter().filter_map(pair).collect(), unlike)
}

fn scale(pairs: &[Pair]) -> f64 {
    let mut values: Vec<f64> = pairs.iter().map(|pair| pair.standardized).collect();
    SIGMA_PER_MAD * median_absolute_deviation(&mut values).unwrap_or(0.0)
}

fn centre(pairs: &[Pair]) -> Vector3<f64> {
    pairs.iter().map(|pair| pair.point_m).sum::<Vector3<f64>>() / pairs.len() as f64
}

/// Root mean square distance of the points from their centre: what turns an angle into a length.
fn lever(pairs: &[Pair], centre: &Vector3<f64>) -> f64 {
    (pairs.iter().map(|pair| (pair.point_m - centre).norm_squared()).sum::<f64>() / pairs.len() as f64).sqrt()
}

fn turned_about(centre: &Vector3<f64>, motion: &Rigid) -> Rigid {
    let translation = centre + motion.translation - motion.rotation * centre;
    Rigid { rotation: motion.rotation, translation }
}

/// `Σ w J Jᵀ`, `Σ w J r` and `Σ w`, J the derivative of a point's distance from its plane by a turn about the centre
/// and a shift.
fn normal_equations(pairs: &[Pair], centre: &Vector3<f64>, scale: f64) -> (Matrix6<f64>, Vector6<f64>, f64) {
    let (mut normal, mut moment, mut total) = (Matrix6::zeros(), Vector6::zeros(), 0.0);
    for pair in pairs {
        let turn = (pair.point_m - centre).cross(&pair.normal);
        let shift = pair.normal;
        let derivative = Vector6::new(turn[0], turn[1], turn[2], shift[0], shift[1], shift[2]);
        let robust = Loss::Tukey.weight(pair.standardized / scale.max(1e-9), false);
        let weight = robust / (pair.error_m * pair.error_m);
        normal += weight * derivative * derivative.transpose();
        moment += weight * pair.standardized * pair.error_m * derivative;
        total += weight;
    }
    (normal, moment, total)
}
