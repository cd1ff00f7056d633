//! Cubic B-splines on equal intervals of x, and integrals of products of their sums.

use nalgebra::{DMatrix, DVector};

/// Places and weights of Gauss and Legendre's rule on 0..1 with four points: exact up to the seventh degree, that of
/// a product of two cubics being the sixth.
const QUADRATURE: [(f64, f64); 4] = [
    (0.069_431_844_202_973_71, 0.173_927_422_568_726_93),
    (0.330_009_478_207_571_87, 0.326_072_577_431_273_07),
    (0.669_990_521_792_428_1, 0.326_072_577_431_273_07),
    (0.930_568_155_797_026_3, 0.173_927_422_568_726_93),
];

/// Cubic B-splines on `intervals` equal intervals between two ends: `intervals + 3` of them, which sum to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Basis {
    start: f64,
    width: f64,
    intervals: usize,
}

impl Basis {
    pub(crate) fn new(start: f64, end: f64, intervals: usize) -> Self {
        Self { start, width: (end - start) / intervals as f64, intervals }
    }

    pub(crate) fn len(self) -> usize {
        self.intervals + 3
    }

    /// The first of the four B-splines that are not 0 at `x`, and the values of the four. Outside the ends, the
    /// polynomials of the outermost interval go on.
    pub(crate) fn at(self, x: f64) -> (usize, [f64; 4]) {
        let position = (x - self.start) / self.width;
        let interval = (position as usize).min(self.intervals - 1);
        let t = position - interval as f64;
        (interval, pieces(t))
    }

    /// `Σ c_k B_k(x)`; NaN when coefficients are missing.
    pub(crate) fn sum(self, coefficients: &[f64], x: f64) -> f64 {
        let (first, values) = self.at(x);
        let used = coefficients.get(first..first + 4).unwrap_or(&[f64::NAN]);
        used.iter().zip(values).map(|(c, value)| c * value).sum()
    }

    /// Coefficients whose sum is the straight line x: the Greville points.
    pub(crate) fn line(self) -> DVector<f64> {
        DVector::from_fn(self.len(), |k, _| self.start + (k as f64 - 1.0) * self.width)
    }

    /// The matrix M of `cᵀ M c = ∫ s² dx`.
    pub(crate) fn mass(self) -> DMatrix<f64> {
        self.integral(pieces)
    }

    /// The matrix D of `cᵀ D c = ∫ s′² dx`.
    pub(crate) fn steepness(self) -> DMatrix<f64> {
        let width = self.width;
        self.integral(move |t| {
            let s = 1.0 - t;
            let inner = |t: f64| (9.0 * t * t - 12.0 * t) / 6.0;
            [-s * s / 2.0, inner(t), -inner(s), t * t / 2.0].map(|slope| slope / width)
        })
    }

    /// `∫ f_i f_j dx` for the four functions that `values` gives at each place 0..1 of an interval.
    fn integral(self, values: impl Fn(f64) -> [f64; 4]) -> DMatrix<f64> {
        let mut sum = DMatrix::zeros(self.len(), self.len());
        for (place, weight) in QUADRATURE {
            let values = values(place);
            for interval in 0..self.intervals {
                for (i, a) in values.iter().enumerate() {
                    for (j, b) in values.iter().enumerate() {
                        sum[(interval + i, interval + j)] += self.width * weight * a * b;
                    }
                }
            }
        }
        sum
    }

    /// The matrix P of `cᵀ P c = ∫ s″² dx`. The second derivative of a cubic spline is piecewise linear, with the
    /// second difference of the coefficients over the squared width at each knot; the square of a line from a to b
    /// integrates to `width (a² + ab + b²) / 3`.
    pub(crate) fn curvature(self) -> DMatrix<f64> {
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

/// The four B-splines at a place 0..1 of an interval.
fn pieces(t: f64) -> [f64; 4] {
    let s = 1.0 - t;
    [
        s * s * s / 6.0,
        (4.0 + 3.0 * t * t * (t - 2.0)) / 6.0,
        (4.0 + 3.0 * s * s * (s - 2.0)) / 6.0,
        t * t * t / 6.0,
    ]
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

    #[test]
    fn a_line_has_no_curvature_and_its_square_and_slope_integrate_exactly() {
        let basis = Basis::new(-0.5, 1.5, 5);
        let line = basis.line();
        let of = |matrix: DMatrix<f64>| (line.transpose() * matrix * &line)[(0, 0)];
        // ∫ x² dx from −0.5 to 1.5, and ∫ 1 dx; rounding of some hundred products.
        assert!((of(basis.mass()) - (1.5f64.powi(3) + 0.5f64.powi(3)) / 3.0).abs() < 1e-13);
        assert!((of(basis.steepness()) - 2.0).abs() < 1e-13);
        assert!(of(basis.curvature()).abs() < 1e-10);
        let parabola = DVector::from_fn(basis.len(), |k, _| {
            ((k as f64 - 1.0) * 0.4 - 0.5).powi(2) - 0.4f64.powi(2) / 3.0
        });
        // x² has the slope 2x.
        let slope = (parabola.transpose() * basis.steepness() * &parabola)[(0, 0)];
        assert!((slope - 4.0 * (1.5f64.powi(3) + 0.5f64.powi(3)) / 3.0).abs() < 1e-12, "{slope}");
    }
}
