//! Where an axis has its ticks, and what they say.

use crate::numbers::{scientific, superscript};

/// Decimal exponents between which a number is written out; beyond, as a power of ten.
const PLAIN: std::ops::RangeInclusive<i32> = -3..=5;

/// Ticks of an axis.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Ticks {
    /// Values with a label.
    pub(super) labelled: Vec<(f64, String)>,
    /// Values between them that get a faint line.
    pub(super) minor: Vec<f64>,
}

/// Distance of the ticks: 1, 2 or 5 times a power of ten, about `count` of them from `low` to `high`.
pub(super) fn step(low: f64, high: f64, count: usize) -> f64 {
    let rough = (high - low) / count.max(1) as f64;
    let decade = 10f64.powf(rough.log10().floor());
    let part = rough / decade;
    let mantissa = match part {
        _ if part < 1.5 => 1.0,
        _ if part < 3.0 => 2.0,
        _ if part < 7.0 => 5.0,
        _ => 10.0,
    };
    decade * mantissa
}

/// Ticks of equal differences from `low` to `high`, about `count`.
pub(super) fn linear(low: f64, high: f64, count: usize) -> Ticks {
    let step = step(low, high, count);
    let (first, last) = ((low / step - 1e-6).ceil(), (high / step + 1e-6).floor());
    // Where the step is below the resolution of f64 there is nothing between the ends.
    let sound = step.is_normal() && last - first <= 50.0 && first.abs() < 1e15 && low + step > low;
    let values: Vec<f64> = if sound {
        (0..=(last - first) as u32).map(|index| (first + f64::from(index)) * step).collect()
    } else {
        vec![low, high]
    };
    let digits = Digits::of(&values, if sound { step } else { high - low });
    Ticks {
        labelled: values.into_iter().map(|value| (value, digits.write(value))).collect(),
        minor: Vec::new(),
    }
}

/// Ticks of equal ratios from `low` to `high`, both positive, about `count`.
pub(super) fn logarithmic(low: f64, high: f64, count: usize) -> Ticks {
    let (first, last) = (low.log10().floor() as i32, high.log10().ceil() as i32);
    let inside = |value: &f64| *value >= low * (1.0 - 1e-9) && *value <= high * (1.0 + 1e-9);
    let of = |mantissas: &[u32]| -> Vec<(u32, i32)> {
        let all = (first..=last).flat_map(|power| mantissas.iter().map(move |&mantissa| (mantissa, power)));
        all.filter(|&(mantissa, power)| inside(&round_value(mantissa, power))).collect()
    };
    let decades = (high / low).log10();
    let mut chosen = of(&[1]);
    if decades < 2.5 {
        chosen = if decades < 1.3 { of(&[1, 2, 3, 5, 7]) } else { of(&[1, 2, 5]) };
        if chosen.len() < 3 {
            chosen = of(&[1, 2, 3, 4, 5, 6, 7, 8, 9]);
        }
        if chosen.len() < 3 {
            return linear(low, high, count);
        }
    } else if chosen.len() > count {
        let stride = chosen.len().div_ceil(count.max(1)) as i32;
        chosen.retain(|(_, power)| power.rem_euclid(stride) == 0);
    }
    let minor = if decades <= 6.0 { of(&[1, 2, 3, 4, 5, 6, 7, 8, 9]) } else { Vec::new() };
    let minor = minor.into_iter().filter(|tick| !chosen.contains(tick));
    let plain = chosen.iter().all(|(_, power)| PLAIN.contains(power));
    Ticks {
        minor: minor.map(|(mantissa, power)| round_value(mantissa, power)).collect(),
        labelled: chosen
            .iter()
            .map(|&(m, power)| (round_value(m, power), round_label(m, power, plain)))
            .collect(),
    }
}

/// `mantissa`·10^`power`, as the decimal number that it is.
fn round_value(mantissa: u32, power: i32) -> f64 {
    format!("{mantissa}e{power}").parse().unwrap_or(f64::NAN)
}

fn round_label(mantissa: u32, power: i32, plain: bool) -> String {
    match (mantissa, power) {
        _ if plain => format!("{:.*}", power.min(0).unsigned_abs() as usize, round_value(mantissa, power)),
        (_, 0) => mantissa.to_string(),
        (1, _) => format!("10{}", superscript(power)),
        _ => format!("{mantissa}×10{}", superscript(power)),
    }
}

/// How the numbers of one axis are written: all with the same decimals.
enum Digits {
    Plain(usize),
    Scientific(usize),
}

impl Digits {
    /// For `values` that differ by multiples of `step`.
    fn of(values: &[f64], step: f64) -> Self {
        let largest = values.iter().fold(0.0f64, |largest, value| largest.max(value.abs()));
        let (power, step_power) = (exponent(largest), exponent(step));
        if largest == 0.0 || (power <= *PLAIN.end() && step_power >= *PLAIN.start()) {
            Self::Plain(step_power.min(0).unsigned_abs() as usize)
        } else {
            Self::Scientific((power - step_power).clamp(0, 15) as usize)
        }
    }

    fn write(&self, value: f64) -> String {
        match self {
            _ if value == 0.0 => "0".to_owned(),
            Self::Plain(decimals) => format!("{value:.*}", (*decimals).min(15)),
            Self::Scientific(decimals) => scientific(value, *decimals),
        }
    }
}

/// Decimal exponent of a positive number; rounding errors of a step such as 0.9999·10ⁿ are forgiven.
fn exponent(value: f64) -> i32 {
    (value.log10() + 1e-9).floor() as i32
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(ticks: &Ticks) -> Vec<&str> {
        ticks.labelled.iter().map(|(_, label)| label.as_str()).collect()
    }

    #[test]
    fn linear_ticks_are_round_numbers_with_equal_decimals() {
        assert_eq!(labels(&linear(0.0, 30.0, 6)), ["0", "5", "10", "15", "20", "25", "30"]);
        assert_eq!(labels(&linear(0.24, 1.1, 5)), ["0.4", "0.6", "0.8", "1.0"]);
        assert_eq!(labels(&linear(-1e7, 1e7, 2)), ["-1×10⁷", "0", "1×10⁷"]);
        assert_eq!(labels(&linear(0.0, 2e-6, 2)), ["0", "1×10⁻⁶", "2×10⁻⁶"]);
    }

    #[test]
    fn logarithmic_ticks_suit_the_span() {
        assert_eq!(labels(&logarithmic(0.5, 2000.0, 6)), ["1", "10", "100", "1000"]);
        assert_eq!(labels(&logarithmic(0.9, 25.0, 6)), ["1", "2", "5", "10", "20"]);
        assert_eq!(labels(&logarithmic(0.5, 3.0, 6)), ["0.5", "0.7", "1", "2", "3"]);
        assert_eq!(labels(&logarithmic(1.02, 1.18, 3)), ["1.05", "1.10", "1.15"]);
        assert_eq!(labels(&logarithmic(1e-12, 1e12, 4)), ["10⁻⁷", "1", "10⁷"]);
        assert_eq!(labels(&logarithmic(2e-5, 200.0, 4)), ["10⁻⁴", "10⁻²", "1", "10²"]);
    }

    #[test]
    fn odd_ranges_end_quickly_with_few_ticks() {
        let odd = [
            (0.0, f64::MAX / 4.0),
            (1e9, 1e9 + 1e-6),
            (5e-324, 1e-323),
            (-1e300, 1e300),
            (1.0, 1.0 + f64::EPSILON),
        ];
        for (low, high) in odd {
            let count = linear(low, high, 6).labelled.len();
            assert!((1..=20).contains(&count), "{low} to {high}: {count}");
        }
        for (low, high) in [(5e-324, f64::MAX), (1e-300, 1.1e-300), (1.0, 1.0 + f64::EPSILON)] {
            let count = logarithmic(low, high, 6).labelled.len();
            assert!((1..=20).contains(&count), "{low} to {high}: {count}");
        }
    }
}
