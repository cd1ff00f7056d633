//! What the vendor's scaling means, in words.

use std::fmt;

use serde::Serialize;

use super::effect::{Estimate, State};
use super::scaling::Scaling;

/// A factor within this of 1 at the corner is none.
const EVEN: f64 = 0.1;
/// An interval that reaches into that margin must not leave this multiple of it, as of a [`State`].
const WIDEST: f64 = 3.0;
/// A root mean square residual of ln(vendor/raw) beyond this: the law is not the vendor's.
const LOOSE: f64 = 0.15;

/// How the vendor's amplitude depends on time, distance and place, relative to the raw amplitude.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct VendorFinding {
    /// Exponent of t in vendor/raw; `None` where it is not determined.
    pub time_exponent: Option<f64>,
    /// `Present`: the vendor corrects fully for t; `Removed`: t has no effect.
    pub time: Option<State>,
    /// Exponent of d in vendor/raw; `None` where it is not determined.
    pub distance_exponent: Option<f64>,
    /// `Present`: the vendor corrects fully for d⁻²; `Removed`: d has no effect.
    pub distance: Option<State>,
    /// Factor at r = 1 relative to the principal point; `None` where it is not determined.
    pub corner_factor: Option<f64>,
    /// True when that factor is 1 within its interval and 10 %; `None` where it is not determined or the interval
    /// is too wide.
    pub even: Option<bool>,
    /// Root mean square residual of ln(vendor/raw).
    pub residual_rms: f64,
    /// False when the residual is so large that the scaling is something else than powers.
    pub is_powers: bool,
    /// True when the residual is mere rounding.
    pub exact: bool,
}

impl From<&Scaling> for VendorFinding {
    fn from(scaling: &Scaling) -> Self {
        let time = scaling.time.as_ref().ok();
        let distance = scaling.distance.as_ref().ok();
        let corner = scaling.radial.as_ref().ok().map(|radial| radial.corner_factor);
        // Minus the vendor's exponent is that of an effect that the vendor takes out.
        let minus = |estimate: &Estimate| estimate.divided_by(-1.0);
        Self {
            time_exponent: time.map(|time| time.value),
            time: time.map(|time| State::of_time(minus(time))),
            distance_exponent: distance.map(|distance| distance.value),
            distance: distance.map(|distance| State::of_distance(minus(distance))),
            corner_factor: corner.map(|corner| corner.value),
            even: corner.and_then(is_even),
            residual_rms: scaling.residual_rms,
            is_powers: scaling.residual_rms < LOOSE,
            exact: scaling.exact,
        }
    }
}

/// Is this factor none? `None` where its interval allows both.
fn is_even(corner: Estimate) -> Option<bool> {
    if !corner.reaches(1.0 - EVEN, 1.0 + EVEN) {
        return Some(false);
    }
    corner.lies_within(1.0 - WIDEST * EVEN, 1.0 + WIDEST * EVEN).then_some(true)
}

impl VendorFinding {
    /// A few words for the headline.
    pub(super) fn short(&self) -> String {
        if !self.is_powers {
            return "the vendor's scaling is no power law".to_owned();
        }
        let mut words = Vec::new();
        let mut tell = |name: &str, state: Option<State>| match state {
            Some(State::Present) => words.push(format!("takes {name} out")),
            Some(State::Removed) => words.push(format!("leaves {name} in")),
            Some(State::Undetermined) | None => {}
            Some(_) => words.push(format!("changes the effect of {name}")),
        };
        tell("integration time", self.time);
        tell("distance", self.distance);
        words.extend((self.even == Some(false)).then(|| "has a radial term".to_owned()));
        if words.is_empty() {
            words.push("has no effect that could be told".to_owned());
        }
        format!("the vendor's scaling {}", words.join(", "))
    }
}

impl fmt::Display for VendorFinding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if !self.is_powers {
            return write!(
                f,
                "The vendor's image is no product of powers of time and distance and a radial term: such a law misses it \
                 by {:.0} % (root mean square). The exponents below are averages.",
                100.0 * self.residual_rms
            );
        }
        let mut parts = Vec::new();
        parts.extend(self.time_exponent.map(|exponent| match self.time {
            Some(State::Present) => format!("takes the integration time out (t^{exponent:.2})"),
            Some(State::Removed) => format!("leaves the integration time in (t^{exponent:.2})"),
            Some(State::Undetermined) => format!("has an uncertain exponent of time (t^{exponent:.2})"),
            _ => format!("goes with t^{exponent:.2}"),
        }));
        parts.extend(self.distance_exponent.map(|exponent| match self.distance {
            Some(State::Present) => format!("takes the distance out (d^{exponent:.2})"),
            Some(State::Removed) => format!("has no distance term (d^{exponent:.2})"),
            Some(State::Undetermined) => format!("has an uncertain exponent of distance (d^{exponent:.2})"),
            _ => format!("goes with d^{exponent:.2}"),
        }));
        parts.extend(self.corner_factor.map(|factor| match self.even {
            Some(true) => "has no radial term".to_owned(),
            None => format!(
                "may or may not have a radial term (a factor of {factor:.2} at the corner, uncertain)"
            ),
            Some(false) => format!("has a radial term, a factor of {factor:.2} at the corner (r = 1)"),
        }));
        let exact =
            if self.exact { " The relation is exact: one image was computed from the other." } else { "" };
        write!(f, "The vendor's scaling {}.{exact}", parts.join("; "))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wide_interval_tells_no_radial_term_and_none_at_all() {
        let even = |value, low_95, high_95| is_even(Estimate { value, low_95, high_95 });
        assert_eq!(even(1.02, 0.97, 1.07), Some(true));
        assert_eq!(even(1.3, 1.25, 1.35), Some(false));
        assert_eq!(even(1.5, 0.9, 2.5), None);
        assert_eq!(even(1.0, 0.5, 2.0), None);
    }
}
