//! From the values of an axis to places on it.

use super::ticks::{self, Ticks};
use crate::page::{Axis, Scale};

/// Part of the range that an axis is longer than its data, at either end.
const MARGIN: f64 = 0.03;
/// Values beyond this are left out: differences of two of them would overflow.
const LARGEST: f64 = 1e300;

/// Scale and ends of one axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Extent {
    scale: Scale,
    low: f64,
    high: f64,
}

impl Extent {
    /// The range that the axis asks for, where it is one; otherwise that of the `values` that can be drawn.
    pub(super) fn of(axis: &Axis, values: impl Iterator<Item = f64>) -> Self {
        let scale = axis.scale;
        if let Some((low, high)) = axis.range.map(|(a, b)| (a.min(b), a.max(b)))
            && drawable(scale, low)
            && drawable(scale, high)
            && low < high
        {
            return Self { scale, low, high };
        }
        let (low, high) = values
            .filter(|&value| drawable(scale, value))
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(value), high.max(value)));
        match scale {
            Scale::Linear => Self::around_linear(low, high),
            Scale::Log => Self::around_log(low, high),
        }
    }

    fn around_linear(low: f64, high: f64) -> Self {
        let (low, high) = match low.partial_cmp(&high) {
            Some(std::cmp::Ordering::Less) => {
                let margin = MARGIN * (high - low);
                // An axis of quantities that cannot be negative starts at zero, not below.
                let below = if low >= 0.0 { (low - margin).max(0.0) } else { low - margin };
                (below, high + margin)
            }
            Some(std::cmp::Ordering::Equal) if low == 0.0 => (-1.0, 1.0),
            Some(std::cmp::Ordering::Equal) => (low - 0.1 * low.abs(), low + 0.1 * low.abs()),
            _ => (0.0, 1.0),
        };
        // A difference that f64 cannot hold is no axis.
        if high > low { Self { scale: Scale::Linear, low, high } } else { Self::around_linear(0.0, 1.0) }
    }

    fn around_log(low: f64, high: f64) -> Self {
        let (low, high) = match low.partial_cmp(&high) {
            Some(std::cmp::Ordering::Less) => {
                let margin = (high.ln() - low.ln()) * MARGIN;
                ((low.ln() - margin).exp(), (high.ln() + margin).exp())
            }
            Some(std::cmp::Ordering::Equal) => (low / 2.0, high * 2.0),
            _ => (1.0, 10.0),
        };
        // Margins may lead out of what f64 can hold.
        let (low, high) = (low.max(f64::MIN_POSITIVE), high.clamp(2.0 * f64::MIN_POSITIVE, f64::MAX));
        Self { scale: Scale::Log, low, high }
    }

    /// The same, with ends at round numbers.
    pub(super) fn rounded(self, axis: &Axis, count: usize) -> Self {
        if axis.range.is_some() || self.scale == Scale::Log {
            return self;
        }
        let mut rounded = self;
        // The longer axis may want a longer step; then round to that.
        for _ in 0..3 {
            let step = ticks::step(rounded.low, rounded.high, count);
            let (low, high) = ((self.low / step).floor() * step, (self.high / step).ceil() * step);
            if !(low.is_finite() && high.is_finite() && low < high) {
                return self;
            }
            rounded = Self { low, high, ..self };
        }
        rounded
    }

    /// 0 at the low end, 1 at the high end; `None` for a value that the axis cannot show.
    pub(super) fn place(&self, value: f64) -> Option<f64> {
        if !drawable(self.scale, value) {
            return None;
        }
        let place = match self.scale {
            Scale::Linear => (value - self.low) / (self.high - self.low),
            Scale::Log => (value.ln() - self.low.ln()) / (self.high.ln() - self.low.ln()),
        };
        place.is_finite().then_some(place)
    }

    /// About `count` ticks.
    pub(super) fn ticks(&self, count: usize) -> Ticks {
        match self.scale {
            Scale::Linear => ticks::linear(self.low, self.high, count),
            Scale::Log => ticks::logarithmic(self.low, self.high, count),
        }
    }
}

/// Whether an axis of that scale can show the value.
pub(super) fn drawable(scale: Scale, value: f64) -> bool {
    value.is_finite() && value.abs() <= LARGEST && (scale == Scale::Linear || value >= f64::MIN_POSITIVE)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn axis(scale: Scale, range: Option<(f64, f64)>) -> Axis {
        Axis { label: String::new(), scale, range }
    }

    #[test]
    fn ends_are_at_zero_and_one() {
        for (scale, range) in [(Scale::Linear, (2.0, 6.0)), (Scale::Log, (1.0, 100.0))] {
            let extent = Extent::of(&axis(scale, Some(range)), std::iter::empty());
            assert_eq!(extent.place(range.0), Some(0.0));
            assert_eq!(extent.place(range.1), Some(1.0));
        }
        let log = Extent::of(&axis(Scale::Log, Some((1.0, 100.0))), std::iter::empty());
        assert_eq!(log.place(10.0), Some(0.5));
        assert_eq!(log.place(0.0), None);
        assert_eq!(log.place(-1.0), None);
    }

    #[test]
    fn any_data_gives_an_axis() {
        let data = [
            vec![],
            vec![f64::NAN, f64::INFINITY],
            vec![0.0],
            vec![-3.0],
            vec![1e300, -1e300],
            vec![5e-324, 1e-323],
            vec![1e-300, 1e300],
            vec![1.0, 1.0 + f64::EPSILON],
            vec![f64::MAX],
        ];
        for scale in [Scale::Linear, Scale::Log] {
            for range in [None, Some((f64::NAN, 1.0)), Some((3.0, 3.0)), Some((-1.0, 1.0)), Some((9.0, 1.0))]
            {
                for values in &data {
                    let wanted = axis(scale, range);
                    let extent = Extent::of(&wanted, values.iter().copied()).rounded(&wanted, 6);
                    assert!(extent.low < extent.high, "{scale:?} {range:?} {values:?}: {extent:?}");
                    assert!(!extent.ticks(6).labelled.is_empty(), "{scale:?} {range:?} {values:?}");
                }
            }
        }
    }
}
