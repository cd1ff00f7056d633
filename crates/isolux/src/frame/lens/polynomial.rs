//! Distortion of the image plane by polynomials: Brown–Conrady (`k1`, `k2`, `p1`, `p2`, `k3`), and the rational model
//! that divides by a second polynomial (`k4`, `k5`, `k6`), as OpenCV defines them:
//!
//! `x' = x q + 2 p₁ x y + p₂ (r² + 2 x²)`, `y' = y q + p₁ (r² + 2 y²) + 2 p₂ x y`,
//! `q = (1 + k₁ r² + k₂ r⁴ + k₃ r⁶) / (1 + k₄ r² + k₅ r⁴ + k₆ r⁶)`, `r² = x² + y²`.

use super::solve;

/// Tangent of the largest angle off the axis that is looked at: 87°.
const FARTHEST: f64 = 20.0;
/// Newton's steps from the solution without `p1` and `p2`, which are small.
const ROUNDS: usize = 40;
/// What is left of the equation when it counts as solved; the tests ask for 1e-9.
const SOLVED: f64 = 1e-12;

/// The coefficients, and how far they make sense.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Polynomial {
    /// `k1` to `k3` above, `k4` to `k6` below the line.
    k: [f64; 6],
    p: [f64; 2],
    /// Distance from the axis up to which the distorted image does not fold back.
    domain: f64,
}

impl Polynomial {
    /// `coefficients` in OpenCV's order: k1, k2, p1, p2, k3, k4, k5, k6; those that are not there are 0.
    pub(super) fn new(coefficients: &[f64]) -> Self {
        let at = |index: usize| coefficients.get(index).copied().unwrap_or(0.0);
        let [k1, k2, p1, p2, k3, k4, k5, k6] = [0, 1, 2, 3, 4, 5, 6, 7].map(at);
        let mut polynomial = Self { k: [k1, k2, k3, k4, k5, k6], p: [p1, p2], domain: FARTHEST };
        polynomial.domain = solve::growing_until(|r| polynomial.radial(r).1, FARTHEST);
        polynomial
    }

    pub(super) fn is_within(&self, [x, y]: [f64; 2]) -> bool {
        x.hypot(y) <= self.domain
    }

    /// q, and its derivative by r². NaN where the denominator is not positive: beyond a pole.
    fn ratio(&self, r2: f64) -> (f64, f64) {
        let [k1, k2, k3, k4, k5, k6] = self.k;
        let series = |a: f64, b: f64, c: f64| 1.0 + r2 * (a + r2 * (b + r2 * c));
        let slope = |a: f64, b: f64, c: f64| a + r2 * (2.0 * b + r2 * 3.0 * c);
        let (above, below) = (series(k1, k2, k3), series(k4, k5, k6));
        if below <= 0.0 {
            return (f64::NAN, f64::NAN);
        }
        let q = above / below;
        (q, (slope(k1, k2, k3) - q * slope(k4, k5, k6)) / below)
    }

    /// r q, and its derivative by r.
    fn radial(&self, r: f64) -> (f64, f64) {
        let (q, dq) = self.ratio(r * r);
        (r * q, q + 2.0 * r * r * dq)
    }

    /// The distorted place of an undistorted one.
    pub(super) fn distort(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let r2 = x * x + y * y;
        let (q, _) = self.ratio(r2);
        let [p1, p2] = self.p;
        [
            x * q + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x),
            y * q + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y,
        ]
    }

    /// The undistorted place of a distorted one; `None` outside the domain.
    pub(super) fn undistort(&self, distorted: [f64; 2]) -> Option<[f64; 2]> {
        let mut place = self.start(distorted);
        for _ in 0..ROUNDS {
            let [x, y] = self.distort(place);
            let (ex, ey) = (distorted[0] - x, distorted[1] - y);
            if ex.abs().max(ey.abs()) <= SOLVED {
                return self.is_within(place).then_some(place);
            }
            let [[a, b], [c, d]] = self.jacobian(place);
            let determinant = a * d - b * c;
            if determinant.is_nan() || determinant <= 0.0 {
                return None;
            }
            place[0] += (d * ex - b * ey) / determinant;
            place[1] += (a * ey - c * ex) / determinant;
        }
        None
    }

    /// The solution without `p1` and `p2`; the edge of the domain beyond it, since they may reach back into it.
    fn start(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let distorted = x.hypot(y);
        if distorted == 0.0 {
            return [0.0; 2];
        }
        let r = solve::root(|r| self.radial(r), self.domain, distorted).unwrap_or(self.domain);
        [x * r / distorted, y * r / distorted]
    }

    fn jacobian(&self, [x, y]: [f64; 2]) -> [[f64; 2]; 2] {
        let (q, dq) = self.ratio(x * x + y * y);
        let [p1, p2] = self.p;
        let cross = 2.0 * x * y * dq + 2.0 * p1 * x + 2.0 * p2 * y;
        [
            [q + 2.0 * x * x * dq + 2.0 * p1 * y + 6.0 * p2 * x, cross],
            [cross, q + 2.0 * y * y * dq + 6.0 * p1 * y + 2.0 * p2 * x],
        ]
    }
}
