//! The soft full well and its hard clip.

use crate::model::CameraModel;

/// Charge that a pixel keeps of the charge that it receives: `f(x) = x / (1 + (x/W)^p)^(1/p)`, cut off at
/// `c W` (methods, section 1).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FullWell {
    /// W, electrons.
    pub capacity_electrons: f64,
    /// p, dimensionless; the larger, the later and sharper the compression.
    pub softness: f64,
    /// c, dimensionless, below 1.
    pub clip_fraction: f64,
}

impl FullWell {
    /// The well of `model`.
    #[must_use]
    pub fn of(model: &CameraModel) -> Self {
        Self {
            capacity_electrons: model.full_well_electrons,
            softness: model.softness,
            clip_fraction: model.clip_fraction,
        }
    }

    /// f without the hard clip, electrons from electrons.
    #[must_use]
    pub fn soft_electrons(&self, received_electrons: f64) -> f64 {
        let fill = received_electrons / self.capacity_electrons;
        received_electrons / libm::pow(1.0 + libm::pow(fill, self.softness), 1.0 / self.softness)
    }

    /// f with the hard clip, electrons from electrons.
    #[must_use]
    pub fn kept_electrons(&self, received_electrons: f64) -> f64 {
        self.soft_electrons(received_electrons).min(self.clip_electrons())
    }

    /// Slope f′, dimensionless: `(1 + (x/W)^p)^(−1−1/p)`, 0 beyond the clip. It is what is left of a small
    /// modulation, `a / a_lin ≈ f′(O_lin)`: eq. 3 of Stürmer, Penne and Hornegger (2008).
    #[must_use]
    pub fn slope(&self, received_electrons: f64) -> f64 {
        if received_electrons >= self.received_at_clip_electrons() {
            return 0.0;
        }
        let fill = received_electrons / self.capacity_electrons;
        libm::pow(1.0 + libm::pow(fill, self.softness), -1.0 - 1.0 / self.softness)
    }

    /// The most that a pixel keeps: c W, electrons.
    #[must_use]
    pub fn clip_electrons(&self) -> f64 {
        self.clip_fraction * self.capacity_electrons
    }

    /// Received charge at which the clip is reached: `W c / (1 − c^p)^(1/p)`, electrons.
    #[must_use]
    pub fn received_at_clip_electrons(&self) -> f64 {
        let room = 1.0 - libm::pow(self.clip_fraction, self.softness);
        self.clip_electrons() / libm::pow(room, 1.0 / self.softness)
    }
}

/// [`FullWell::kept_electrons`] by linear interpolation: two powers for each of the bins of each frame would
/// take longer than all the rest.
#[derive(Clone, Debug)]
pub(crate) struct FullWellTable {
    kept_electrons: Vec<f64>,
    intervals_per_electron: f64,
    clip_electrons: f64,
}

impl FullWellTable {
    /// Linear interpolation errs by at most f″/8 per squared interval; |f″| < (p+1)/W, so 4096 intervals over
    /// at most 3 W keep the error below 1e-6 W for p up to 12.
    const INTERVALS: usize = 4096;

    pub(crate) fn new(well: &FullWell) -> Self {
        let step = well.received_at_clip_electrons() / Self::INTERVALS as f64;
        let kept_electrons =
            (0..=Self::INTERVALS).map(|index| well.kept_electrons(index as f64 * step)).collect();
        Self { kept_electrons, intervals_per_electron: 1.0 / step, clip_electrons: well.clip_electrons() }
    }

    #[inline]
    pub(crate) fn kept_electrons(&self, received_electrons: f64) -> f64 {
        let position = received_electrons * self.intervals_per_electron;
        let index = position as usize;
        match self.kept_electrons.get(index..index.saturating_add(2)) {
            Some(&[low, high]) => low + (high - low) * (position - index as f64),
            _ => self.clip_electrons,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wells() -> impl Iterator<Item = FullWell> {
        [(4.0, 0.96), (5.5, 0.97), (8.0, 0.9), (12.0, 0.99)]
            .into_iter()
            .map(|(softness, clip_fraction)| FullWell { capacity_electrons: 1e5, softness, clip_fraction })
    }

    #[test]
    fn small_charges_are_kept_whole_and_large_ones_clipped() {
        for well in wells() {
            assert!((well.kept_electrons(100.0) - 100.0).abs() < 1e-7);
            assert_eq!(well.kept_electrons(1e7), well.clip_electrons());
            let at_clip = well.received_at_clip_electrons();
            assert!((well.soft_electrons(at_clip) / well.clip_electrons() - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn the_slope_is_the_derivative() {
        for well in wells() {
            for fill in [0.1, 0.5, 0.9, 1.1] {
                let received = fill * well.capacity_electrons;
                // Central difference: its own error is f‴ h²/6 < 1e-6 for h = 1e-4 W, p ≤ 12.
                let step = 10.0;
                let difference = (well.soft_electrons(received + step)
                    - well.soft_electrons(received - step))
                    / (2.0 * step);
                if received < well.received_at_clip_electrons() {
                    assert!((well.slope(received) - difference).abs() < 1e-6);
                }
            }
            assert_eq!(well.slope(5.0 * well.capacity_electrons), 0.0);
        }
    }

    #[test]
    fn the_table_follows_the_formula() {
        for well in wells() {
            let table = FullWellTable::new(&well);
            for step in 0..20_000 {
                let received = f64::from(step) * 17.3;
                let error = table.kept_electrons(received) - well.kept_electrons(received);
                assert!(error.abs() < 1e-6 * well.capacity_electrons, "{received}: {error}");
            }
        }
    }
}
