//! The soft full well: the charge that a pixel keeps as a function of the charge that it receives, both in units of
//! the well W.
//!
//! `f(x) = x / (1 + x^p)^(1/p)`, x the linear fill (methods, section 1). Its slope f′ is what is left of a small
//! modulation, `a / a_lin ≈ f′(x)`: eq. 3 of Stürmer, Penne and Hornegger (2008).

use crate::terms::check::{Check, ParameterError};

/// The shape of a soft full well.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SoftWell {
    /// p, dimensionless: the larger, the later and sharper the compression. Infinity compresses nothing below 1.
    pub softness: f64,
}

impl SoftWell {
    /// Softnesses that a fit may find: 1 bends from the first photon on, 16 is nearly a corner.
    pub const SOFTNESS_LIMITS: std::ops::RangeInclusive<f64> = 1.0..=16.0;

    /// Refuses a softness that no fit gives.
    pub(super) fn check_at(self, here: &Check<'_>) -> Result<(), ParameterError> {
        let fine = Self::SOFTNESS_LIMITS.contains(&self.softness);
        here.at("softness").require(fine, self.softness, "a softness from 1 to 16")
    }

    /// f: kept fill of a linear fill x ≥ 0.
    #[must_use]
    pub fn kept(self, fill: f64) -> f64 {
        fill / (1.0 + fill.powf(self.softness)).powf(1.0 / self.softness)
    }

    /// f′: slope at a linear fill x ≥ 0, `(1 + x^p)^(−1−1/p)`.
    #[must_use]
    pub fn slope(self, fill: f64) -> f64 {
        (1.0 + fill.powf(self.softness)).powf(-1.0 - 1.0 / self.softness)
    }

    /// f⁻¹: linear fill of a kept fill k, `k / (1 − k^p)^(1/p)`; infinite from k = 1 on, and k itself below 0, where
    /// there is only noise.
    #[must_use]
    pub fn received(self, kept: f64) -> f64 {
        if kept >= 1.0 {
            return f64::INFINITY;
        }
        if kept <= 0.0 {
            return kept;
        }
        kept / (1.0 - kept.powf(self.softness)).powf(1.0 / self.softness)
    }

    /// Kept fill at which the slope is `slope` (0 to 1): `(1 − s^(p/(p+1)))^(1/p)`.
    #[must_use]
    pub fn kept_at_slope(self, slope: f64) -> f64 {
        let p = self.softness;
        (1.0 - slope.powf(p / (p + 1.0))).powf(1.0 / p)
    }

    /// Linear fill at which `x f′(x)`, the amplitude over time, is largest: `p^(−1/p)`.
    #[must_use]
    pub fn fill_at_peak(self) -> f64 {
        self.softness.powf(-1.0 / self.softness)
    }
}

/// f⁻¹ as a table for the loop over pixels, in DN: powers for every bin of every frame would take longer than all the
/// rest of the chain.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct InverseTable {
    full_well_dn: f64,
    intervals_per_fill: f64,
    largest_kept: f64,
    received: Vec<f64>,
}

impl InverseTable {
    /// Linear interpolation errs by at most `h²/8 · max (f⁻¹)″`, `(f⁻¹)″ = (p+1) k^(p−1) (1−k^p)^(−2−1/p)`: where the
    /// slope f′ is the least that a tier inverts (0.2), p ≤ 16, below 400. With 4096 intervals that is 3e-6 of W.
    const INTERVALS: usize = 4096;

    /// The table of a well of `full_well_dn` up to `largest_kept_dn`, both above the black level.
    pub(crate) fn new(well: SoftWell, full_well_dn: f64, largest_kept_dn: f64) -> Self {
        let largest_kept = largest_kept_dn / full_well_dn;
        let step = largest_kept / Self::INTERVALS as f64;
        let received = (0..=Self::INTERVALS).map(|i| well.received(i as f64 * step)).collect();
        Self { full_well_dn, intervals_per_fill: 1.0 / step, largest_kept, received }
    }

    /// Largest kept charge that the table covers, DN above the black level.
    pub(crate) fn largest_kept_dn(&self) -> f64 {
        self.largest_kept * self.full_well_dn
    }

    /// Received charge and its slope d(received)/d(kept), of a kept charge in DN above the black level; `None` above
    /// the table and for NaN. Below 0 there is only noise, which is passed on.
    #[inline]
    pub(crate) fn received_dn(&self, kept_dn: f64) -> Option<(f64, f64)> {
        if kept_dn <= 0.0 {
            return Some((kept_dn, 1.0));
        }
        let position = kept_dn / self.full_well_dn * self.intervals_per_fill;
        let index = position as usize;
        match self.received.get(index..index.saturating_add(2)) {
            Some(&[low, high]) if position >= 0.0 => {
                let fill = low + (high - low) * (position - index as f64);
                Some((fill * self.full_well_dn, (high - low) * self.intervals_per_fill))
            }
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn values_by_hand() {
        // p = 2: f(1) = 1/√2, f′(1) = 2^(−3/2), peak of x f′ at 1/√2.
        let well = SoftWell { softness: 2.0 };
        let half = std::f64::consts::FRAC_1_SQRT_2;
        assert!((well.kept(1.0) - half).abs() < 1e-15);
        assert!((well.slope(1.0) - half * 0.5).abs() < 1e-15);
        assert!((well.fill_at_peak() - half).abs() < 1e-15);
        assert_eq!((well.received(1.0), well.received(-0.25)), (f64::INFINITY, -0.25));
    }

    proptest! {
        #[test]
        fn the_inverse_undoes_the_well_and_the_slope_is_its_derivative(p in 1.0..16.0f64, x in 1e-6..1.5f64) {
            let well = SoftWell { softness: p };
            let kept = well.kept(x);
            prop_assert!(kept <= x && kept < 1.0);
            // One ulp of the kept fill is worth d(received)/d(kept) = 1/f′ of the received; the powers add p of them.
            let tolerance = 8.0 * p * f64::EPSILON / well.slope(x);
            prop_assert!((well.received(kept) / x - 1.0).abs() <= tolerance);
            // Central difference: f‴ h²/6 with f‴ < p³, and 2 ulp / 2h of rounding.
            let h = 1e-5 * x;
            let difference = (well.kept(x + h) - well.kept(x - h)) / (2.0 * h);
            prop_assert!((difference - well.slope(x)).abs() < p.powi(3) * 1e-10 + 1e-10);
            prop_assert!((well.slope(well.received(well.kept_at_slope(0.3))) / 0.3 - 1.0).abs() < 1e-10);
        }

        #[test]
        fn the_peak_is_the_largest_amplitude_over_time(p in 1.0..16.0f64, share in 0.5..1.5f64) {
            let well = SoftWell { softness: p };
            let amplitude = |x: f64| x * well.slope(x);
            let peak = well.fill_at_peak();
            prop_assert!(amplitude(peak * share) <= amplitude(peak) * (1.0 + 4.0 * f64::EPSILON));
        }

        #[test]
        fn the_table_equals_the_inverse(p in 1.0..16.0f64, share in 0.0..0.999f64) {
            let well = SoftWell { softness: p };
            let largest = 5000.0 * well.kept_at_slope(0.2);
            let table = InverseTable::new(well, 5000.0, largest);
            let exact = 5000.0 * well.received(share * largest / 5000.0);
            let (found, slope) = table.received_dn(share * largest).unwrap();
            // The bound that `INTERVALS` states.
            prop_assert!((found - exact).abs() < 3e-6 * 5000.0, "{found} {exact}");
            prop_assert!((1.0..6.0).contains(&(slope + 1e-9)));
            prop_assert!(table.received_dn(1.001 * largest).is_none());
            prop_assert!(table.received_dn(f64::NAN).is_none());
        }
    }
}
