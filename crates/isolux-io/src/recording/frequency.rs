//! The modulation frequency of a recording, or two.

use isolux::phase::SPEED_OF_LIGHT_M_PER_S;
use serde::{Deserialize, Serialize};

/// Two frequencies whose common divisor is a smaller share of the higher one tell no distances apart: the steps between
/// them are within their noise.
const MOST_WRAPS: f64 = 64.0;
/// Of two frequencies that are as good as equal, the divisor is the frequency itself.
const FEWEST_WRAPS: f64 = 1.5;
/// Frequencies are not exact multiples of their divisor: a remainder of this share of the lower one is none.
const REMAINDER: f64 = 0.005;

/// What the light is modulated with, Hz.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum ModulationFrequency {
    /// One frequency.
    Single(f64),
    /// Two, which together tell distances apart over a longer range: that of the first half of the phase samples and
    /// that of the second half.
    Pair([f64; 2]),
}

impl From<f64> for ModulationFrequency {
    fn from(frequency_hz: f64) -> Self {
        Self::Single(frequency_hz)
    }
}

impl ModulationFrequency {
    /// The frequency that amplitude, phase and noise of the distance refer to: of two, the higher one, whose distance is
    /// the finer.
    #[must_use]
    pub fn hz(&self) -> f64 {
        match *self {
            Self::Single(frequency_hz) => frequency_hz,
            Self::Pair([first, second]) => first.max(second),
        }
    }

    /// The range within which distances are told apart, m: c/2f, where f is the common divisor of two frequencies.
    #[must_use]
    pub fn unambiguous_range_m(&self) -> f64 {
        let divisor_hz = match *self {
            Self::Single(frequency_hz) => frequency_hz,
            Self::Pair([first, second]) => divisor(first, second),
        };
        SPEED_OF_LIGHT_M_PER_S / (2.0 * divisor_hz)
    }

    /// True where frequencies can be used: positive, and two of them unlike, with a divisor that is not too small.
    pub(crate) fn is_usable(&self) -> bool {
        let fine = |frequency_hz: f64| frequency_hz > 0.0 && frequency_hz.is_finite();
        match *self {
            Self::Single(frequency_hz) => fine(frequency_hz),
            Self::Pair([first, second]) => {
                let wraps = self.hz() / divisor(first, second);
                fine(first) && fine(second) && (FEWEST_WRAPS..MOST_WRAPS).contains(&wraps)
            }
        }
    }
}

/// The common divisor of two frequencies, by Euclid's algorithm.
fn divisor(first: f64, second: f64) -> f64 {
    let (mut high, mut low) = (first.max(second), first.min(second));
    let least = REMAINDER * low;
    while low > least && low > 0.0 {
        let quotient = (high / low).round();
        (high, low) = (low, (high - quotient * low).abs());
    }
    high
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_range_is_that_of_the_common_divisor() {
        let range = |pair| ModulationFrequency::Pair(pair).unambiguous_range_m();
        // c / 2f for 15, 20 and 16 MHz.
        assert!((range([60e6, 75e6]) - 9.993_081_9).abs() < 1e-6);
        assert!((range([100e6, 80e6]) - 7.494_811_5).abs() < 1e-6);
        // As a camera may write them: 16.02 divides 80.32 but for 0.2.
        assert!((range([80.32e6, 16.06e6]) - 9.333_512).abs() < 0.01);
        assert!((ModulationFrequency::Single(20e6).unambiguous_range_m() - 7.494_811_5).abs() < 1e-6);
    }

    #[test]
    fn frequencies_that_tell_nothing_apart_are_refused() {
        let usable = |pair| ModulationFrequency::Pair(pair).is_usable();
        assert!(usable([60e6, 75e6]) && usable([80e6, 16e6]));
        for pair in
            [[60e6, 60e6], [60e6, 0.0], [-60e6, 75e6], [f64::NAN, 75e6], [61e6, 100e6], [60e6, 60.1e6]]
        {
            assert!(!usable(pair), "{pair:?}");
        }
        assert!(!ModulationFrequency::Single(f64::INFINITY).is_usable());
    }
}
