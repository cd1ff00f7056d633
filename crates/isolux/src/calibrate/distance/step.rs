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

/// A smooth law is a cubic in ln d here, of each time its own: for unsaturated amplitudes it is good to 2 %.
const COEFFICIENTS: usize = 4;
/// Positions that a time needs to take part.
const LEAST_POINTS: usize = 7;
/// A change must be larger than what a cubic leaves of a smooth law, three times.
const LEAST_CHANGE: f64 = 0.05;
/// It must explain this share of what the smooth law leaves, ...
const LEAST_SHARE: f64 = 0.7;
/// ... and be this many standard errors large.
const STANDARD_ERRORS: f64 = 6.0;
/// Share of a change that the law must not be able to take up.
const LEAST_FREE_SHARE: f64 = 0.02;

/// The change that explains the points best, if it is one. Points beyond saturation must not be among them.
pub(super) fn step(points: &[Point]) -> Option<Step> {
    let times = points.iter().map(|point| point.time).max()? + 1;
    let groups: Vec<Vec<&Point>> = (0..times)
        .map(|time| points.iter().filter(|point| point.time == time).collect::<Vec<_>>())
        .filter(|group| group.len() >= LEAST_POINTS)
        .collect();
    let smooth: Vec<(&Vec<&Point>, DMatrix<f64>)> =
        groups.iter().map(|group| Some((group, left_by_law(group)?))).collect::<Option<_>>()?;
    let left = |values: &dyn Fn(&Point) -> f64| -> Vec<DVector<f64>> {
        let vector = |group: &[&Point]| DVector::from_iterator(group.len(), group.iter().map(|p| values(p)));
        smooth.iter().map(|(group, left)| left * vector(group)).collect()
    };
    let dot = |a: &[DVector<f64>], b: &[DVector<f64>]| a.iter().zip(b).map(|(a, b)| a.dot(b)).sum::<f64>();
    let levels = left(&|point| point.ln_level);
    let all = dot(&levels, &levels);
    let count: usize = groups.iter().map(Vec::len).sum();
    let free = count.checked_sub(COEFFICIENTS * groups.len() + 2).filter(|free| *free > 0)? as f64;
    let mut frames: Vec<usize> = groups.iter().flatten().map(|point| point.frame).collect();
    frames.sort_unstable();
    frames.dedup();
    let candidate = |&frame: &usize| {
        let changed = left(&|point| f64::from(u8::from(point.frame >= frame)));
        let (with, own) = (dot(&changed, &levels), dot(&changed, &changed));
        (own > LEAST_FREE_SHARE * count as f64)
            .then(|| (with * with / own, Step { frame, ln_factor: with / own }, own))
    };
    let (explained, step, own) = frames.iter().filter_map(candidate).max_by(|a, b| a.0.total_cmp(&b.0))?;
    let error = ((all - explained).max(0.0) / free / own).sqrt();
    let is_one =
        step.ln_factor.abs() > LEAST_CHANGE.max(STANDARD_ERRORS * error) && explained > LEAST_SHARE * all;
    is_one.then_some(step)
}

/// The matrix that takes a smooth law out of the levels of a time.
fn left_by_law(group: &[&Point]) -> Option<DMatrix<f64>> {
    let count = group.len();
    let middle = group.iter().map(|point| point.ln_distance).sum::<f64>() / count as f64;
    let powers = DMatrix::from_fn(count, COEFFICIENTS, |row, power| {
        (group[row].ln_distance - middle).powi(i32::try_from(power).unwrap_or(0))
    });
    let inverse = (powers.transpose() * &powers).try_inverse()?;
    Some(DMatrix::identity(count, count) - &powers * inverse * powers.transpose())
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
