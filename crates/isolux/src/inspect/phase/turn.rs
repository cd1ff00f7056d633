//! The ways to read four bins: which of them are opposite, where the phase starts, and which way it runs.

use std::f64::consts::{FRAC_PI_2, TAU};

use crate::frame::PhaseConvention;

/// One way to read bins, told by how it departs from another.
///
/// Of the 24 orders and two signs, 24 differ: reading the phase backwards is the same as swapping A2 and A4. The
/// amplitude only depends on which bins are opposite (three ways); the start and the direction of the phase (eight
/// ways each) turn and mirror the phase, and so change the distance.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Turn {
    pub(super) pairs: Pairs,
    /// True where the phase runs the other way.
    pub(super) reversed: bool,
    /// Quarters of a turn by which the phase starts earlier, 0..4.
    pub(super) quarters: usize,
}

/// Which bins are opposite, half a turn apart. The first and third of each order are, and the second and fourth.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Pairs(pub(super) [usize; 4]);

impl Pairs {
    /// Those of the paper, and the other two.
    pub(super) const ALL: [Self; 3] = [Self::STATED, Self([0, 2, 1, 3]), Self([0, 1, 3, 2])];
    pub(super) const STATED: Self = Self([0, 1, 2, 3]);

    /// Differences of the opposite bins, the cosine and the sine, each of twice the amplitude.
    pub(super) fn differences(self, bins: [f32; 4]) -> [f64; 2] {
        let [a, b, c, d] = self.0.map(|bin| f64::from(bins[bin]));
        [a - c, b - d]
    }

    /// By how much the sums of opposite bins differ: not at all, but for noise, where these bins are opposite.
    pub(super) fn imbalance(self, bins: [f32; 4]) -> f64 {
        let [a, b, c, d] = self.0.map(|bin| f64::from(bins[bin]));
        a + c - b - d
    }
}

impl Turn {
    /// The bins as they are read.
    pub(super) const STATED: Self = Self { pairs: Pairs::STATED, reversed: false, quarters: 0 };

    /// All ways to read bins of which these are opposite.
    pub(super) fn all(pairs: Pairs) -> impl Iterator<Item = Self> {
        let both = [false, true].into_iter();
        both.flat_map(move |reversed| (0..4).map(move |quarters| Self { pairs, reversed, quarters }))
    }

    /// The phase that is read as `phase`, rad, as this way reads it: 0..2π.
    pub(super) fn of(self, phase: f64) -> f64 {
        let phase = if self.reversed { -phase } else { phase };
        (phase + self.quarters as f64 * FRAC_PI_2).rem_euclid(TAU)
    }

    /// The convention of bins that have been read by `stated` and should have been read this way.
    pub(super) fn convention(self, stated: PhaseConvention) -> PhaseConvention {
        let [a, b, c, d] = self.pairs.0;
        let mut order = if self.reversed { [a, d, c, b] } else { [a, b, c, d] };
        order.rotate_right(self.quarters);
        let positions = stated.positions();
        let order = order.map(|bin| positions[bin]);
        // Each way has two names. The one with the order that the recording has already is easier to believe.
        let backwards = PhaseConvention { order: [order[0], order[3], order[2], order[1]], reversed: true };
        if backwards.order == stated.order { backwards } else { PhaseConvention { order, reversed: false } }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Bins of amplitude 1 of a phase, as a camera of this convention delivers them.
    fn delivered(phase: f64, convention: PhaseConvention) -> [f32; 4] {
        let mut bins = [0.0; 4];
        for (bin, position) in convention.positions().into_iter().enumerate() {
            bins[position] = (phase - bin as f64 * FRAC_PI_2).cos() as f32;
        }
        bins
    }

    #[test]
    fn each_way_reads_what_its_convention_delivers() {
        let stated = PhaseConvention { order: [3, 1, 0, 2], reversed: true };
        let mut found = Vec::new();
        for turn in Pairs::ALL.into_iter().flat_map(Turn::all) {
            let convention = turn.convention(stated);
            let file = delivered(0.7, convention);
            let read = stated.positions().map(|position| file[position]);
            let [cosine, sine] = turn.pairs.differences(read);
            assert!((turn.of(sine.atan2(cosine)) - 0.7).abs() < 1e-6, "{turn:?}");
            assert!(turn.pairs.imbalance(read).abs() < 1e-6);
            found.push(convention.positions());
        }
        found.sort_unstable();
        found.dedup();
        assert_eq!(found.len(), 24);
        assert_eq!(Turn::STATED.convention(PhaseConvention::default()), PhaseConvention::default());
    }

    #[test]
    fn a_sign_is_said_as_a_sign() {
        let stated = PhaseConvention { order: [0, 2, 1, 3], reversed: false };
        let turn = Turn { reversed: true, ..Turn::STATED };
        assert_eq!(turn.convention(stated), PhaseConvention { reversed: true, ..stated });
        let back = turn.convention(PhaseConvention { reversed: true, ..stated });
        assert_eq!(back, stated);
    }
}
