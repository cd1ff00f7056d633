//! Polynomials of degree 3 over distance: least squares, and the form that the loop over pixels evaluates.

use nalgebra::{DMatrix, DVector};

/// A multiplier over distance: a cubic between two distances, continued with the slope of d² outside.
///
/// `square` and `eq5` are cubics without limits, so that one loop serves every distance law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct DistanceGain {
    /// Coefficients of 1, d, d², d³ with d in metres.
    pub coefficients: [f32; 4],
    /// Lower end of the range, m.
    pub min_m: f32,
    /// Upper end of the range, m.
    pub max_m: f32,
}

impl DistanceGain {
    /// The law that leaves every amplitude as it is.
    pub(crate) const ONE: Self = Self::unbounded([1.0, 0.0, 0.0, 0.0]);

    /// A cubic for all distances.
    #[must_use]
    pub(crate) const fn unbounded(coefficients: [f64; 4]) -> Self {
        Self::between(coefficients, 0.0, f64::INFINITY)
    }

    /// A cubic for `min_m..=max_m`; outside, the multiplier goes on as `P(edge) (d / edge)²`.
    #[must_use]
    pub(crate) const fn between(coefficients: [f64; 4], min_m: f64, max_m: f64) -> Self {
        let [c0, c1, c2, c3] = coefficients;
        Self {
            coefficients: [c0 as f32, c1 as f32, c2 as f32, c3 as f32],
            min_m: min_m as f32,
            max_m: max_m as f32,
        }
    }

    /// The multiplier at one distance (m), its slope (per m) and its curvature (per m²); NaN for NaN. At the ends of
    /// the range those of the inside.
    #[inline(always)]
    #[must_use]
    pub(crate) fn derivatives(&self, distance_m: f32) -> [f32; 3] {
        let [_, c1, c2, c3] = self.coefficients;
        let value = self.at(distance_m);
        let outside = (distance_m < self.min_m) | (distance_m > self.max_m);
        let beyond = 2.0 * value / distance_m;
        let slope = (3.0 * c3 * distance_m + 2.0 * c2) * distance_m + c1;
        let curvature = 6.0 * c3 * distance_m + 2.0 * c2;
        [value, if outside { beyond } else { slope }, if outside { beyond / distance_m } else { curvature }]
    }

    /// The multiplier at one distance (m); NaN for NaN.
    #[inline(always)]
    #[must_use]
    pub(crate) fn at(&self, distance_m: f32) -> f32 {
        let [c0, c1, c2, c3] = self.coefficients;
        let inside = distance_m.max(self.min_m).min(self.max_m);
        let beyond = distance_m / inside;
        (((c3 * inside + c2) * inside + c1) * inside + c0) * (beyond * beyond)
    }
}

/// Evaluates `c0 + c1 x + c2 x² + c3 x³`.
pub(crate) fn evaluate(coefficients: [f64; 4], x: f64) -> f64 {
    let [c0, c1, c2, c3] = coefficients;
    ((c3 * x + c2) * x + c1) * x + c0
}

/// Cubic that minimizes `Σ (P(x) / y − 1)²`: relative errors, because a multiplier's relative error is the
/// relative error of the standardized amplitude. Solved by SVD in `x / max|x|`, where the columns are of like size.
///
/// `None` when fewer than four different x are there, or a value is not finite or y not positive.
pub(crate) fn fit_relative(points: &[(f64, f64)]) -> Option<[f64; 4]> {
    let usable = |&(x, y): &(f64, f64)| x.is_finite() && y.is_finite() && y > 0.0;
    let scale = points.iter().fold(0.0f64, |largest, &(x, _)| largest.max(x.abs()));
    if !points.iter().all(usable) || scale == 0.0 || distinct(points) < 4 {
        return None;
    }
    let design = DMatrix::from_fn(points.len(), 4, |row, power| {
        (points[row].0 / scale).powi(power as i32) / points[row].1
    });
    let target = DVector::from_element(points.len(), 1.0);
    let solution = design.svd(true, true).solve(&target, f64::EPSILON).ok()?;
    let coefficients = [0, 1, 2, 3].map(|power| solution[power] / scale.powi(power as i32));
    coefficients.iter().all(|c| c.is_finite()).then_some(coefficients)
}

/// Number of different x among `points`.
pub(crate) fn distinct(points: &[(f64, f64)]) -> usize {
    let mut xs: Vec<f64> = points.iter().map(|&(x, _)| x).collect();
    xs.sort_by(f64::total_cmp);
    xs.dedup();
    xs.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cubic_is_recovered_from_its_own_points() {
        let truth = [0.2, -0.3, 1.4, 0.05];
        let points: Vec<_> =
            (0..12).map(|i| 0.5 + 0.25 * f64::from(i)).map(|x| (x, evaluate(truth, x))).collect();
        let found = fit_relative(&points).unwrap();
        for (found, truth) in found.iter().zip(truth) {
            // Condition number of the scaled design is below 1e4; SVD loses that many ulps.
            assert!((found - truth).abs() < 1e4 * f64::EPSILON * 10.0, "{found} {truth}");
        }
    }

    #[test]
    fn three_distances_do_not_make_a_cubic() {
        assert_eq!(fit_relative(&[(1.0, 1.0), (2.0, 4.0), (3.0, 9.0), (3.0, 9.1)]), None);
        assert_eq!(fit_relative(&[(1.0, 1.0), (2.0, 4.0), (3.0, 9.0), (4.0, f64::NAN)]), None);
        assert_eq!(fit_relative(&[]), None);
    }

    #[test]
    fn outside_its_range_a_cubic_goes_on_as_the_square() {
        let gain = DistanceGain::between([-3.0, 5.0, 0.0, -1.0], 0.8, 1.5);
        for (outside, edge) in [(0.4f32, 0.8f32), (6.0, 1.5)] {
            let expected = gain.at(edge) * (outside / edge) * (outside / edge);
            assert!((gain.at(outside) / expected - 1.0).abs() <= 4.0 * f32::EPSILON);
        }
        assert!(gain.at(f32::NAN).is_nan());
    }

    #[test]
    fn slope_and_curvature_are_those_of_the_multiplier() {
        let gain = DistanceGain::between([0.3, 0.5, 0.4, 0.1], 0.8, 1.5);
        for distance_m in [0.4f32, 0.9, 1.4, 3.0] {
            // Central differences; f32 keeps 1e-7 of the value, which a step of 0.03 turns into 1e-5 and 4e-4, and
            // the third derivative, 0.6, adds 0.6 h²/6.
            let h = 0.03f32;
            let [below, at, above] =
                [distance_m - h, distance_m, distance_m + h].map(|d| f64::from(gain.at(d)));
            let h = f64::from(h);
            let [value, slope, curvature] = gain.derivatives(distance_m).map(f64::from);
            assert_eq!(value, at);
            assert!((slope - (above - below) / (2.0 * h)).abs() < 3e-4, "{distance_m}: {slope}");
            assert!(
                (curvature - (above - 2.0 * at + below) / (h * h)).abs() < 5e-3,
                "{distance_m}: {curvature}"
            );
        }
    }

    #[test]
    fn the_analytic_laws_are_one_at_the_reference() {
        for gain in [super::super::square::distance_law(0.75), super::super::eq5::distance_law(0.75)] {
            assert!((gain.at(0.75) - 1.0).abs() <= 4.0 * f32::EPSILON);
        }
        assert_eq!(super::super::square::distance_law(1.0).at(3.0), 9.0);
        assert_eq!(super::super::eq5::distance_law(0.5).at(1.0), 2.5);
        assert_eq!(DistanceGain::ONE.at(17.0), 1.0);
    }
}
