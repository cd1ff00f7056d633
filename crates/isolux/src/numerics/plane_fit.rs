//! Weighted least squares of a plane over places in an image, as a correction of a plane that is roughly known: what is
//! summed up are residuals, which are small, so that no digits are lost.

/// `value = middle + along_x x + along_y y`, x and y from the middle of a window.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LocalPlane {
    pub(crate) middle: f64,
    pub(crate) along_x: f64,
    pub(crate) along_y: f64,
}

/// Weighted sums over the places (x, y) of a window and over the residuals r from the known plane.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct PlaneMoments {
    w: f64,
    x: f64,
    y: f64,
    xx: f64,
    xy: f64,
    yy: f64,
    r: f64,
    xr: f64,
    yr: f64,
}

/// Means of the places and their second moments about them.
struct Spread {
    x: f64,
    y: f64,
    xx: f64,
    xy: f64,
    yy: f64,
    determinant: f64,
}

impl LocalPlane {
    /// A plane of one value.
    pub(crate) fn level(middle: f64) -> Self {
        Self { middle, along_x: 0.0, along_y: 0.0 }
    }
}

impl PlaneMoments {
    /// Takes in the residual `r` at one place, of the weight `w`.
    #[inline(always)]
    pub(crate) fn add(&mut self, w: f64, x: f64, y: f64, r: f64) {
        self.w += w;
        self.x += w * x;
        self.y += w * y;
        self.xx += w * x * x;
        self.xy += w * x * y;
        self.yy += w * y * y;
        self.r += w * r;
        self.xr += w * x * r;
        self.yr += w * y * r;
    }

    /// Sum of the weights.
    pub(crate) fn weight(&self) -> f64 {
        self.w
    }

    /// Mean of the residuals.
    pub(crate) fn mean(&self) -> f64 {
        self.r / self.w
    }

    /// The known plane and that of the residuals; `None` where the places lie on a line: where the determinant of their
    /// spread is below `least_spread` of the square of half its trace.
    pub(crate) fn corrected(&self, known: LocalPlane, least_spread: f64) -> Option<LocalPlane> {
        let Spread { x, y, xx, xy, yy, determinant } = self.spread(least_spread)?;
        let r = self.mean();
        let [xr, yr] = [self.xr / self.w - x * r, self.yr / self.w - y * r];
        let along_x = (xr * yy - yr * xy) / determinant;
        let along_y = (yr * xx - xr * xy) / determinant;
        Some(LocalPlane {
            middle: known.middle + r - along_x * x - along_y * y,
            along_x: known.along_x + along_x,
            along_y: known.along_y + along_y,
        })
    }

    /// Variance of the plane in the middle of the window over that of the mean, less 1: what its slopes add. `None` as
    /// above.
    pub(crate) fn variance_of_slopes(&self, least_spread: f64) -> Option<f64> {
        let Spread { x, y, xx, xy, yy, determinant } = self.spread(least_spread)?;
        Some((x * x * yy - 2.0 * x * y * xy + y * y * xx) / determinant)
    }

    fn spread(&self, least: f64) -> Option<Spread> {
        let [x, y] = [self.x, self.y].map(|sum| sum / self.w);
        let [xx, xy, yy] = [self.xx / self.w - x * x, self.xy / self.w - x * y, self.yy / self.w - y * y];
        let determinant = xx * yy - xy * xy;
        let half_trace = 0.5 * (xx + yy);
        let on_a_line = determinant <= least * half_trace * half_trace;
        (!on_a_line).then_some(Spread { x, y, xx, xy, yy, determinant })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_plane_is_found_from_any_other_and_places_on_a_line_have_none() {
        let value = |x: f64, y: f64| 2.0 + 0.3 * x - 0.7 * y;
        let known = LocalPlane { middle: 1.5, along_x: 0.1, along_y: 0.0 };
        let (mut square, mut line) = (PlaneMoments::default(), PlaneMoments::default());
        for (number, (x, y)) in (0u8..).zip([(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (2.0, 1.0)]) {
            let residual = value(x, y) - known.middle - known.along_x * x;
            square.add(1.0 + f64::from(number), x, y, residual);
            line.add(1.0, x, 2.0 * x, residual);
        }
        let found = square.corrected(known, 1e-3).unwrap();
        for (found, truth) in [(found.middle, 2.0), (found.along_x, 0.3), (found.along_y, -0.7)] {
            assert!((found - truth).abs() < 1e-14, "{found} {truth}");
        }
        assert!(line.corrected(known, 1e-3).is_none() && line.variance_of_slopes(1e-3).is_none());
    }
}
