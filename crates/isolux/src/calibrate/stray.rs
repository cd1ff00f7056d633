//! Frames, and positions of a target, that contradict those that should be equal to them.

/// What was left out as stray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Stray {
    /// Number of frames or positions.
    pub(super) count: usize,
    /// A frame of the one that departs most.
    pub(super) worst: usize,
    /// By how much, relative.
    pub(super) departure: f64,
}

/// A frame may differ from its repeats by this share: cameras settle by up to 3 % after a change of the time, and half of
/// it is all that one of two frames adds to an error.
pub(super) const LEAST_DEPARTURE: f64 = 0.05;
/// ... or by this many standard deviations.
pub(super) const DEVIATIONS: f64 = 8.0;

impl Stray {
    /// Of frames and by how much each departs, in ln; `None` without any.
    pub(super) fn of(found: impl Iterator<Item = (usize, f64)>) -> Option<Self> {
        let one = |(worst, departure): (usize, f64)| Self { count: 1, worst, departure: departure.exp_m1() };
        found.map(one).reduce(Self::and)
    }

    /// The two together.
    pub(super) fn and(self, other: Self) -> Self {
        let larger = other.departure.abs() > self.departure.abs();
        Self { count: self.count + other.count, ..if larger { other } else { self } }
    }
}

/// True for two repeats that differ: only others tell which of them is right.
pub(super) fn is_disputed(ln_levels: &[f64], tolerance: f64) -> bool {
    matches!(ln_levels, [a, b] if (a - b).abs() > tolerance)
}

/// Of two repeats that differ, the one that is farther from the `expected` level, and by how much it departs.
pub(super) fn wrong_of_two(ln_levels: &[f64], expected: f64) -> (usize, f64) {
    let away = |index: usize| (ln_levels[index] - expected).abs();
    let wrong = usize::from(away(0) < away(1));
    (wrong, ln_levels[wrong] - ln_levels[1 - wrong])
}

/// Those few repeats that differ from the `middle` of all, and by how much they depart; none where they are not few.
pub(super) fn few_off(ln_levels: &[f64], middle: f64, tolerance: f64) -> Vec<(usize, f64)> {
    let departures = ln_levels.iter().map(|level| level - middle).enumerate();
    let off: Vec<(usize, f64)> = departures.filter(|(_, off)| off.abs() > tolerance).collect();
    if 2 * off.len() < ln_levels.len() { off } else { Vec::new() }
}
