//! The fisheye model of Kannala and Brandt (2006), as OpenCV and ROS ("equidistant") define it: a ray at the angle θ off
//! the axis is shown at `r = θ + k₁ θ³ + k₂ θ⁵ + k₃ θ⁷ + k₄ θ⁹` focal lengths from the principal point.

use std::f64::consts::PI;

use super::solve;

/// The coefficients, and how far they make sense.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Fisheye {
    k: [f64; 4],
    /// Angle up to which r grows, rad.
    domain: f64,
}

impl Fisheye {
    /// Coefficients that are not there are 0.
    pub(super) fn new(coefficients: &[f64]) -> Self {
        let k = [0, 1, 2, 3].map(|index: usize| coefficients.get(index).copied().unwrap_or(0.0));
        let mut fisheye = Self { k, domain: PI };
        fisheye.domain = solve::growing_until(|angle| fisheye.radius(angle).1, PI);
        fisheye
    }

    /// r and its derivative by the angle.
    fn radius(&self, angle: f64) -> (f64, f64) {
        let ([k1, k2, k3, k4], t2) = (self.k, angle * angle);
        let r = angle * (1.0 + t2 * (k1 + t2 * (k2 + t2 * (k3 + t2 * k4))));
        (r, 1.0 + t2 * (3.0 * k1 + t2 * (5.0 * k2 + t2 * (7.0 * k3 + t2 * 9.0 * k4))))
    }

    /// The direction, of unit length, that is shown at a place.
    pub(super) fn ray(&self, [x, y]: [f64; 2]) -> Option<[f64; 3]> {
        let r = x.hypot(y);
        let angle = solve::root(|angle| self.radius(angle), self.domain, r)?;
        // x and y are 0 in the middle, where any direction across the axis does.
        let across = if r > 0.0 { angle.sin() / r } else { 1.0 };
        Some([x * across, y * across, angle.cos()])
    }

    /// The place at which a direction is shown.
    pub(super) fn image(&self, [x, y, z]: [f64; 3]) -> Option<[f64; 2]> {
        let across = x.hypot(y);
        let angle = across.atan2(z);
        // Of the direction straight back, and of none, no place is known.
        let known = angle <= self.domain && (across > 0.0 || z > 0.0);
        let scale = if across > 0.0 { self.radius(angle).0 / across } else { 0.0 };
        known.then_some([x * scale, y * scale])
    }
}
