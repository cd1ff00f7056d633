//! Did the target become darker or brighter in the course of a sweep? A law over distance is smooth, a change is not.

use nalgebra::{DMatrix, DVector};

/// A position of the target at one integration time.
#[derive(Clone, Copy, Debug)]
pub(super) struct Point {
    /// Number of the integration time.
    pub(super) time: usize,
    /// Number of a frame.
    pub(super) frame: usize,
    /// ln of the distance.
    pub(super) ln_distance: f64,
    /// ln of the amplitude times the square of the distance.
    pub(super) ln_level: f64,
}

/// A change of all positions from one frame on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Step {
    pub(super) frame: usize,
    /// Change in ln.
    pub(super) ln_factor: f64,
}

/// A smooth law is a cubic in ln d here, the same for all times but for the level of each: for unsaturated amplitudes it
/// is good to 2 %.
const POWERS: usize = 3;
/// Positions that a time needs to take part: fewer tell little more than its level.
const LEAST_POINTS: usize = 4;
/// A change must be larger than what a cubic leaves of a smooth law, three times.
const LEAST_CHANGE: f64 = 0.05;
/// It must explain this share of what the smooth law leaves, ...
const LEAST_SHARE: f64 = 0.7;
/// ... and be this many standard errors large.
const STANDARD_ERRORS: f64 = 6.0;
/// Points by which a change must be seen that the law cannot take up.
const LEAST_FREE: f64 = 0.4;

/// The change that explains the points best, if it is one. Points beyond saturation must not be among them.
pub(super) fn step(points: &[Point]) -> Option<Step> {
    let points = of_well_seen_times(points);
    let left = left_by_law(&points)?;
    let of = |value: &dyn Fn(&Point) -> f64| {
        &left * DVector::from_iterator(points.len(), points.iter().map(value))
    };
    let levels = of(&|point| point.ln_level);
    let all = levels.norm_squared();
    let free = left.trace() - 1.0;
    let mut frames: Vec<usize> = points.iter().map(|point| point.frame).collect();
    frames.sort_unstable();
    frames.dedup();
    let candidate = |&frame: &usize| {
        let changed = of(&|point| f64::from(u8::from(point.frame >= frame)));
        let (with, own) = (changed.dot(&levels), changed.norm_squared());
        (own > LEAST_FREE).then(|| (with * with / own, Step { frame, ln_factor: with / own }, own))
    };
    let (explained, step, own) = frames.iter().filter_map(candidate).max_by(|a, b| a.0.total_cmp(&b.0))?;
    let error = ((all - explained).max(0.0) / free / own).sqrt();
    let is_one = free > 0.0
        && step.ln_factor.abs() > LEAST_CHANGE.max(STANDARD_ERRORS * error)
        && explained > LEAST_SHARE * all;
    is_one.then_some(step)
}

fn of_well_seen_times(points: &[Point]) -> Vec<Point> {
    let seen = |time: usize| points.iter().filter(|point| point.time == time).count();
    points.iter().copied().filter(|point| seen(point.time) >= LEAST_POINTS).collect()
}

/// The matrix that takes a smooth law and the level of each time out of the levels of the points.
fn left_by_law(points: &[Point]) -> Option<DMatrix<f64>> {
    let count = points.len();
    let mut times: Vec<usize> = points.iter().map(|point| point.time).collect();
    times.sort_unstable();
    times.dedup();
    let middle = points.iter().map(|point| point.ln_distance).sum::<f64>() / count.max(1) as f64;
    let law = DMatrix::from_fn(count, POWERS + times.len(), |row, column| {
        let point = &points[row];
        match i32::try_from(column) {
            Ok(power) if column < POWERS => (point.ln_distance - middle).powi(power + 1),
            _ => f64::from(u8::from(times[column - POWERS] == point.time)),
        }
    });
    let inverse = (law.transpose() * &law).try_inverse()?;
    Some(DMatrix::identity(count, count) - &law * inverse * law.transpose())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn points(factor: impl Fn(usize) -> f64) -> Vec<Point> {
        let point = |index: usize| {
            let ln_distance = (0.4 * 1.15f64.powi(index as i32)).ln();
            let rough = 0.002 * ((index * 7 % 5) as f64 - 2.0);
            let ln_level = 0.3 * ln_distance.sin() + rough + factor(index).ln();
            Point { time: index % 2, frame: 10 * index, ln_distance, ln_level }
        };
        (0..20).map(point).collect()
    }

    #[test]
    fn a_change_is_found_where_it_is_and_a_smooth_law_has_none() {
        assert_eq!(step(&points(|_| 1.0)), None);
        let found = step(&points(|index| if index < 12 { 1.0 } else { 0.7 })).unwrap();
        assert_eq!(found.frame, 120);
        assert!((found.ln_factor - 0.7f64.ln()).abs() < 0.02, "{found:?}");
        assert_eq!(step(&points(|index| 1.0 + 0.02 * index as f64)), None);
    }
}
