//! One measured figure, with what it should be.

use std::fmt;

/// How a figure is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    /// A share of 1, written in percent.
    Percent,
    /// A ratio, written as it is.
    Ratio,
    /// A length in metres, written in millimetres.
    Metre,
    /// A duration in seconds.
    Second,
}

/// What a figure should be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Aim {
    /// Not larger, by its absolute value.
    AtMost(f64),
    /// Not smaller.
    AtLeast(f64),
    /// Between the two, ends included.
    Within(f64, f64),
    /// Shown for comparison.
    None,
}

/// One figure.
#[derive(Clone, Debug, PartialEq)]
pub struct Figure {
    /// Term or step that it is about, by its name on the command line.
    pub subject: &'static str,
    /// What was measured, on what.
    pub what: String,
    /// The value; NaN where it could not be measured.
    pub value: f64,
    /// How it is written.
    pub unit: Unit,
    /// What it should be.
    pub aim: Aim,
}

impl Figure {
    /// A figure.
    #[must_use]
    pub fn new(subject: &'static str, what: impl Into<String>, value: f64, unit: Unit, aim: Aim) -> Self {
        Self { subject, what: what.into(), value, unit, aim }
    }

    /// Whether the aim is met; `None` for a figure without one.
    #[must_use]
    pub fn met(&self) -> Option<bool> {
        match self.aim {
            Aim::AtMost(bound) => Some(self.value.abs() <= bound),
            Aim::AtLeast(bound) => Some(self.value >= bound),
            Aim::Within(low, high) => Some((low..=high).contains(&self.value)),
            Aim::None => None,
        }
    }

    /// The value with its unit.
    #[must_use]
    pub fn value_text(&self) -> String {
        self.unit.write(self.value)
    }

    /// The aim in words; empty where there is none.
    #[must_use]
    pub fn aim_text(&self) -> String {
        match self.aim {
            Aim::AtMost(bound) => format!("≤ {}", self.unit.write(bound)),
            Aim::AtLeast(bound) => format!("≥ {}", self.unit.write(bound)),
            Aim::Within(low, high) => format!("{} to {}", self.unit.write(low), self.unit.write(high)),
            Aim::None => String::new(),
        }
    }
}

impl Unit {
    fn write(self, value: f64) -> String {
        if value.is_nan() {
            return "not measured".to_owned();
        }
        match self {
            Self::Percent => format!("{:.2} %", 100.0 * value),
            Self::Ratio => format!("{value:.3}"),
            Self::Metre => format!("{:.2} mm", 1000.0 * value),
            Self::Second => format!("{value:.1} s"),
        }
    }
}

impl fmt::Display for Figure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}: {}", self.subject, self.what, self.value_text())
    }
}

/// The largest of the values; NaN where any is missing, so that a figure that was not measured meets no aim.
pub(crate) fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(f64::NEG_INFINITY, |a, b| if a.is_nan() || b.is_nan() { f64::NAN } else { a.max(b) })
}

/// The smallest; NaN where any is missing.
pub(crate) fn smallest(values: impl Iterator<Item = f64>) -> f64 {
    -largest(values.map(|value| -value))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn aims_are_kept_at_their_ends_and_never_by_what_is_missing() {
        let met = |value, aim| Figure::new("lut", "", value, Unit::Percent, aim).met();
        assert_eq!(met(0.015, Aim::AtMost(0.015)), Some(true));
        assert_eq!(met(-0.02, Aim::AtMost(0.015)), Some(false));
        assert_eq!(met(0.66, Aim::Within(0.66, 0.7)), Some(true));
        assert_eq!(met(0.5, Aim::None), None);
        for aim in [Aim::AtMost(1.0), Aim::AtLeast(0.0), Aim::Within(0.0, 1.0)] {
            assert_eq!(met(f64::NAN, aim), Some(false));
        }
    }

    #[test]
    fn a_missing_value_is_not_lost_among_the_others() {
        assert_eq!((largest([1.0, 3.0].into_iter()), smallest([1.0, 3.0].into_iter())), (3.0, 1.0));
        for values in [[f64::NAN, 1.0], [1.0, f64::NAN]] {
            assert!(largest(values.into_iter()).is_nan() && smallest(values.into_iter()).is_nan());
        }
    }

    #[test]
    fn figures_are_written_in_their_unit() {
        let figure = Figure::new("spline", "decay", 0.0123, Unit::Percent, Aim::AtMost(0.015));
        assert_eq!((figure.value_text(), figure.aim_text()), ("1.23 %".to_owned(), "≤ 1.50 %".to_owned()));
    }
}
