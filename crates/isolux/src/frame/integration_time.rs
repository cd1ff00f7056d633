//! The integration time of a frame, and when two times count as equal.

use super::Plane;

/// Integration time of a frame, in microseconds per phase sample.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum IntegrationTime {
    /// Not recorded.
    #[default]
    Unknown,
    /// One time for all pixels: finite and positive.
    PerFrame(f64),
    /// One time for each pixel; NaN or 0 where it is unknown, otherwise positive.
    PerPixel(Plane<f32>),
}

impl IntegrationTime {
    /// Times that differ by less than this factor count as equal: cameras report them with jitter.
    pub const SAME_RATIO: f64 = 1.01;

    /// Time of a pixel, µs; `None` where it is unknown: not recorded, or no positive number.
    #[must_use]
    pub fn at(&self, index: usize) -> Option<f64> {
        let time_us = match self {
            Self::Unknown => return None,
            Self::PerFrame(time_us) => *time_us,
            Self::PerPixel(map) => f64::from(map.values()[index]),
        };
        (time_us > 0.0 && time_us.is_finite()).then_some(time_us)
    }

    /// True when two times count as one: both unknown (0), or both known and less than a factor `ratio` apart.
    pub(crate) fn same(first_us: impl Into<f64>, second_us: impl Into<f64>, ratio: f64) -> bool {
        let (first_us, second_us) = (first_us.into(), second_us.into());
        first_us == second_us
            || (first_us.min(second_us) > 0.0 && first_us.max(second_us) < ratio * first_us.min(second_us))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::Shape;

    #[test]
    fn a_pixel_has_a_time_where_a_positive_number_is_recorded() {
        assert_eq!(IntegrationTime::Unknown.at(0), None);
        assert_eq!(IntegrationTime::PerFrame(0.1).at(7), Some(0.1));
        assert_eq!(IntegrationTime::PerFrame(f64::NAN).at(0), None);
        let map = Plane::from_fn(Shape::new(1, 3), |_, column| [f32::NAN, 0.0, 200.0][column]);
        let found = [0, 1, 2].map(|index| IntegrationTime::PerPixel(map.clone()).at(index));
        assert_eq!(found, [None, None, Some(200.0)]);
    }

    #[test]
    fn times_are_one_within_the_ratio_and_unknown_is_only_itself() {
        let same =
            |first_us, second_us| IntegrationTime::same(first_us, second_us, IntegrationTime::SAME_RATIO);
        assert!(same(1000.0, 1009.0) && same(1009.0, 1000.0));
        assert!(!same(1000.0, 1011.0));
        assert!(same(0.0, 0.0) && !same(0.0, 1000.0));
    }
}
