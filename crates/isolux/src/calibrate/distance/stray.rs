//! Frames that contradict their repeats, and positions that contradict their neighbours.

use super::centre::Measurement;
use super::decay::{Position, Positions};
use crate::calibrate::smooth_curve::{departure, expected};
use crate::calibrate::stray::{DEVIATIONS, LEAST_DEPARTURE, Stray, few_off, is_disputed, wrong_of_two};
use crate::numerics::statistics::median;

/// A position may depart from its neighbours by this share: the curve bends, where it saturates.
const LEAST_BEND: f64 = 0.15;
/// ... the nearest and the farthest, which have neighbours on one side only, by this.
const LEAST_BEND_AT_AN_END: f64 = 0.5;

impl Position {
    /// ln of the amplitude times the square of the distance, which changes little from position to position.
    fn ln_levels(&self) -> Vec<f64> {
        self.measurements.iter().map(|m| m.amplitude_dn.ln() + 2.0 * m.distance_m.ln()).collect()
    }

    /// Where it lies on the curve of its time: ln d, ln A d².
    pub(super) fn place(&self) -> (f64, f64) {
        (self.mean(|m| m.distance_m).ln(), median(&mut self.ln_levels()).unwrap_or(f64::NAN))
    }

    /// By how much its frames may differ, in ln.
    fn tolerance(&self) -> f64 {
        LEAST_DEPARTURE.max(DEVIATIONS * self.mean(Measurement::amplitude_error))
    }

    /// Two frames that differ: only other positions tell which is right.
    fn is_disputed(&self) -> bool {
        is_disputed(&self.ln_levels(), self.tolerance())
    }

    /// Frames to leave out, by their place in the position, and by how much they depart.
    fn stray(&self, curve: &[(f64, f64)]) -> Vec<(usize, f64)> {
        let levels = self.ln_levels();
        if self.is_disputed() {
            let expected = expected(curve, self.place().0);
            return expected.map(|level| wrong_of_two(&levels, level)).into_iter().collect();
        }
        few_off(&levels, self.place().1, self.tolerance())
    }
}

impl Positions {
    /// Leaves out frames that contradict their repeats.
    pub(super) fn leave_out_frames(&mut self) -> Option<Stray> {
        let undisputed = self.reliable.iter().filter(|position| !position.is_disputed());
        let mut curve: Vec<(f64, f64)> = undisputed.map(Position::place).collect();
        curve.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut found = Vec::new();
        for position in &mut self.reliable {
            // From the last, so that the places of the others stay.
            for (index, departure) in position.stray(&curve).into_iter().rev() {
                position.measurements.remove(index);
                found.push((position.frames.remove(index), departure));
            }
        }
        Stray::of(found.into_iter())
    }

    /// Leaves out positions that contradict their neighbours, beyond the over-saturated ones.
    pub(super) fn leave_out_positions(&mut self) -> Option<Stray> {
        self.reliable.sort_by(|a, b| a.place().0.total_cmp(&b.place().0));
        let curve: Vec<(f64, f64)> = self.reliable.iter().map(Position::place).collect();
        let ln_amplitude = |at: usize| curve[at].1 - 2.0 * curve[at].0;
        // The median of three: a stray position is no peak.
        let smoothed = |at: usize| {
            let near = at.saturating_sub(1)..(at + 2).min(curve.len());
            median(&mut near.map(ln_amplitude).collect::<Vec<_>>()).unwrap_or(f64::NEG_INFINITY)
        };
        let peak = (0..curve.len()).max_by(|&a, &b| smoothed(a).total_cmp(&smoothed(b)))?;
        let off = |at: usize| {
            let end = at == peak || at + 1 == curve.len();
            let bend = if end { LEAST_BEND_AT_AN_END } else { LEAST_BEND };
            departure(&curve[peak..], at - peak).filter(|departure| departure.abs() > bend)
        };
        let found: Vec<(usize, f64)> =
            (peak..curve.len()).filter_map(|at| off(at).map(|departure| (at, departure))).collect();
        let stray = Stray::of(found.iter().map(|&(at, departure)| (self.reliable[at].frames[0], departure)));
        for (at, _) in found.into_iter().rev() {
            self.reliable.remove(at);
        }
        stray
    }
}
