//! An exponent, and whether it shows that an effect is still present or has been corrected for.

use serde::Serialize;

use crate::numerics::regression::Coefficient;

/// A number with its 95 % confidence interval.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Estimate {
    /// The estimate.
    pub value: f64,
    /// Lower end of the interval.
    pub low_95: f64,
    /// Upper end of the interval.
    pub high_95: f64,
}

impl From<&Coefficient> for Estimate {
    fn from(coefficient: &Coefficient) -> Self {
        let Coefficient { value, low_95, high_95, .. } = *coefficient;
        Self { value, low_95, high_95 }
    }
}

impl Estimate {
    /// The number plus `offset`.
    #[must_use]
    pub fn plus(self, offset: f64) -> Self {
        Self { value: self.value + offset, low_95: self.low_95 + offset, high_95: self.high_95 + offset }
    }

    /// The number divided by `divisor`; a negative one swaps the ends.
    #[must_use]
    pub fn divided_by(self, divisor: f64) -> Self {
        let (first, second) = (self.low_95 / divisor, self.high_95 / divisor);
        Self { value: self.value / divisor, low_95: first.min(second), high_95: first.max(second) }
    }

    /// True when the interval reaches into `low..=high`.
    #[must_use]
    pub fn reaches(self, low: f64, high: f64) -> bool {
        self.low_95 <= high && self.high_95 >= low
    }

    /// True when the interval lies in `low..=high`.
    #[must_use]
    pub fn lies_within(self, low: f64, high: f64) -> bool {
        self.low_95 >= low && self.high_95 <= high
    }
}

/// What was compared to get an exponent.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(tag = "from", rename_all = "snake_case")]
pub enum Evidence {
    /// The same pixels at several integration times.
    StillPixels,
    /// Pixels of one target label.
    Target {
        /// The label.
        label: u8,
    },
    /// Pixels of one vendor amplitude, assumed to be of one reflectivity.
    VendorReflectivity,
}

/// How the amplitude depends on one quantity.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Effect {
    /// Exponent: d ln A / d ln t, d ln A / d ln d, or d ln A / d r².
    pub exponent: Estimate,
    /// What that means.
    pub state: State,
    /// What was compared.
    pub evidence: Evidence,
    /// Standard deviation of ln A around the fit, robust.
    pub residual: f64,
    /// Values that entered.
    pub observations: usize,
}

/// Whether a physical effect is still in the amplitude.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum State {
    /// As physics predicts: not corrected.
    Present,
    /// Not in the amplitude: corrected.
    Removed,
    /// Between the two: partly corrected, or a gamma curve.
    Reduced,
    /// More than physics predicts: a curve steeper than linear.
    Exaggerated,
    /// The other way round: corrected too far.
    Reversed,
    /// The interval is too wide to decide.
    Undetermined,
}

/// Exponents within this of 1 count as physics, and of 0 as corrected, in units of the physical exponent. Time:
/// cameras' dead times and soft wells bend t¹ by up to a tenth. Distance: the ring of light sources, angle of
/// incidence and gloss bend d⁻² by up to a third.
const TIME_MARGIN: f64 = 0.1;
const DISTANCE_MARGIN: f64 = 0.175;
/// An interval that reaches into the margin must not leave this multiple of it.
const WIDEST: f64 = 3.0;
/// |d ln A / d r²| up to this counts as an even image, i.e. 10 % from centre to corner.
const EVEN: f64 = 0.1;

impl State {
    /// Judges an exponent of t.
    #[must_use]
    pub fn of_time(exponent: Estimate) -> Self {
        Self::judge(exponent, TIME_MARGIN)
    }

    /// Judges an exponent of d.
    #[must_use]
    pub fn of_distance(exponent: Estimate) -> Self {
        Self::judge(exponent.divided_by(-2.0), DISTANCE_MARGIN)
    }

    /// Judges a coefficient of r²: physics only knows its sign.
    #[must_use]
    pub fn of_radius(coefficient: Estimate) -> Self {
        if coefficient.reaches(-EVEN, EVEN) {
            let close = coefficient.lies_within(-WIDEST * EVEN, WIDEST * EVEN);
            return if close { Self::Removed } else { Self::Undetermined };
        }
        if coefficient.value < 0.0 { Self::Present } else { Self::Reversed }
    }

    /// `share` is 1 where physics is uncorrected and 0 where it is corrected.
    fn judge(share: Estimate, margin: f64) -> Self {
        let near = |centre: f64| {
            share.reaches(centre - margin, centre + margin)
                && share.lies_within(centre - WIDEST * margin, centre + WIDEST * margin)
        };
        if near(1.0) {
            Self::Present
        } else if near(0.0) {
            Self::Removed
        } else if share.low_95 > 0.0 && share.high_95 < 1.0 {
            Self::Reduced
        } else if share.low_95 > 1.0 {
            Self::Exaggerated
        } else if share.high_95 < 0.0 {
            Self::Reversed
        } else {
            Self::Undetermined
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn between(low_95: f64, high_95: f64) -> Estimate {
        Estimate { value: f64::midpoint(low_95, high_95), low_95, high_95 }
    }

    #[test]
    fn the_interval_decides_not_the_estimate_alone() {
        let time = |low, high| State::of_time(between(low, high));
        assert_eq!(time(0.97, 1.02), State::Present);
        assert_eq!(time(-0.05, 0.02), State::Removed);
        assert_eq!(time(0.45, 0.55), State::Reduced);
        assert_eq!(time(1.9, 2.1), State::Exaggerated);
        assert_eq!(time(-1.1, -0.9), State::Reversed);
        assert_eq!(time(-0.2, 1.2), State::Undetermined);
        assert_eq!(State::of_distance(between(-2.1, -1.9)), State::Present);
        assert_eq!(State::of_distance(between(-0.4, 0.1)), State::Removed);
        assert_eq!(State::of_distance(between(-1.1, -0.9)), State::Reduced);
        assert_eq!(State::of_distance(between(-2.0, 0.0)), State::Undetermined);
        assert_eq!(State::of_radius(between(-0.6, -0.4)), State::Present);
        assert_eq!(State::of_radius(between(-0.2, 0.05)), State::Removed);
    }
}
