//! Cubic B-splines on equal intervals of x, and the curvature of their sums.

use nalgebra::DMatrix;

/// Cubic B-splines on `intervals` equal intervals between two ends: `intervals + 3` of them, which sum to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Basis {
    start: f64,
    width: f64,
    intervals: usize,
}

impl Basis {
    pub(super) fn new(start: f64, end: f64, intervals: usize) -> Self {
        Self { start, width: (end - start) / intervals as f64, intervals }
    }

    pub(super) fn len(self) -> usize {
        self.intervals + 3
    }

    /// The first of the four B-splines that are not 0 at `x`, and the values of the four. Outside the ends, the
    /// polynomials of the outermost interval go on.
    pub(super) fn at(self, x: f64) -> (usize, [f64; 4]) {
        let position = (x - self.start) / self.width;
        let interval = (position as usize).min(self.intervals - 1);
        let t = position - interval as f64;
        let s = 1.0 - t;
        let values = [
            s * s * s / 6.0,
            (4.0 + 3.0 * t * t * (t - 2.0)) / 6.0,
            (4.0 + 3.0 * s * s * (s - 2.0)) / 6.0,
            t * t * t / 6.0,
        ];
        (interval, values)
    }

    /// `Σ c_k B_k(x)`; NaN when coefficients are missing.
    pub(super) fn sum(self, coefficients: &[f64], x: f64) -> f64 {
        let (first, values) = self.at(x);
        let used = coefficients.get(first..first + 4).unwrap_or(&[f64::NAN]);
        used.iter().zip(values).map(|(c, value)| c * value).sum()
    }

    /// The matrix P of `cᵀ P c = ∫ s″² dx`. The second derivative of a cubic spline is piecewise linear, with the
    /// second difference of the coefficients over the squared width at each knot; the square of a line from a to b
    /// integrates to `width (a² + ab + b²) / 3`.
    pub(super) fn curvature(self) -> DMatrix<f64> {
        let knots = self.intervals + 1;
        let second = DMatrix::from_fn(knots, self.len(), |knot, k| match k.wrapping_sub(knot) {
            0 | 2 => 1.0 / (self.width * self.width),
            1 => -2.0 / (self.width * self.width),
            _ => 0.0,
        });
        let mut weights = DMatrix::zeros(knots, knots);
        for i in 0..self.intervals {
            for (row, column, share) in [(i, i, 2.0), (i + 1, i + 1, 2.0), (i, i + 1, 1.0), (i + 1, i, 1.0)] {
                weights[(row, column)] += self.width / 6.0 * share;
            }
        }
        second.transpose() * weights * second
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_splines_sum_to_one_and_follow_a_line() {
        let basis = Basis::new(-1.0, 2.0, 7);
        // Coefficients at the Greville points of equal intervals give the straight line.
        let line: Vec<f64> = (0..basis.len()).map(|k| -1.0 + (k as f64 - 1.0) * 3.0 / 7.0).collect();
        for step in 0..=60 {
            let x = -1.0 + 0.05 * f64::from(step);
            assert!((basis.at(x).1.iter().sum::<f64>() - 1.0).abs() < 1e-15);
            assert!((basis.sum(&line, x) - x).abs() < 1e-14, "{x}");
        }
        assert!((basis.sum(&line, 2.1) - 2.1).abs() < 1e-14 && basis.sum(&line[1..], 2.0).is_nan());
    }

    #[test]
    fn the_curvature_is_the_integral_of_the_squared_second_derivative() {
        let basis = Basis::new(0.0, 1.5, 6);
        let c: Vec<f64> = (0..basis.len()).map(|k| ((k * k) as f64 * 0.7).sin()).collect();
        let vector = nalgebra::DVector::from_column_slice(&c);
        let exact = (vector.transpose() * basis.curvature() * &vector)[(0, 0)];
        // Midpoint rule over numeric second derivatives, which are exact for cubics but for rounding ε/h².
        let (steps, h) = (6000u32, 1e-4);
        let numeric: f64 = (0..steps)
            .map(|i| 1.5 * (f64::from(i) + 0.5) / f64::from(steps))
            .filter(|x| *x > h && *x < 1.5 - h)
            .map(|x| (basis.sum(&c, x - h) - 2.0 * basis.sum(&c, x) + basis.sum(&c, x + h)) / (h * h))
            .map(|second| second * second * 1.5 / f64::from(steps))
            .sum();
        assert!((numeric / exact - 1.0).abs() < 2e-3, "{numeric} {exact}");
    }
}
