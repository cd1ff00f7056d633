//! `knee`: highlights are compressed, not cut off, and keep their order (beyond the paper).
//!
//! Above the cutoff c of the histogram rule, `y = c + (M − c)(1 − e^{−(x − c)/(M − c)})` with M = 1.25 c: continuous with
//! slope 1 at c, increasing, and never above M. What is brighter stays brighter, so that the shape of a highlight
//! remains to be seen.

use super::histogram::HistogramRule;
use crate::frame::PixelFlags;
use crate::numerics::quantile::PositiveQuantiles;

/// (M − c) / c: the range into which highlights are compressed, relative to the cutoff.
const ROOM: f64 = 0.25;

/// Parameters of the knee.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct KneeRule {
    /// The rule that finds the cutoff c.
    pub cutoff: HistogramRule,
}

impl KneeRule {
    pub(super) fn parameters(&self) -> String {
        format!("compressed up to {} times the cutoff, {}", 1.0 + ROOM, self.cutoff.parameters())
    }

    pub(super) fn cutoff(&self, values: &[f32], quantiles: &mut PositiveQuantiles) -> Option<f32> {
        self.cutoff.cutoff(values, quantiles)
    }
}

/// The compressed value of `x` above the cutoff. Computed in f64: its steps between neighbouring f32 are above the
/// rounding of f64 as long as the result is below M in f32, so that rounding cannot exchange two values.
fn compressed(x: f32, cutoff: f32) -> f32 {
    let cutoff = f64::from(cutoff);
    let room = ROOM * cutoff;
    (cutoff - room * libm::expm1(-(f64::from(x) - cutoff) / room)) as f32
}

/// Compresses values above `cutoff` and flags them. Few pixels lie there, so the branch is cheap.
pub(super) fn compress(values: &mut [f32], flags: &mut [PixelFlags], cutoff: f32) {
    for (value, flags) in values.iter_mut().zip(flags) {
        if *value > cutoff {
            *value = compressed(*value, cutoff);
            *flags |= PixelFlags::SPECULAR;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn knee(mut values: Vec<f32>, cutoff: f32) -> (Vec<f32>, Vec<PixelFlags>) {
        let mut flags = vec![PixelFlags::empty(); values.len()];
        compress(&mut values, &mut flags, cutoff);
        (values, flags)
    }

    #[test]
    fn it_starts_with_the_slope_of_one_and_ends_at_five_quarters() {
        // By hand: x = c + (M − c) ln 2 goes half of the way, c + (M − c)/2.
        let (values, flags) = knee(vec![99.0, 100.0, 100.0 + 25.0 * 2f32.ln(), 1e6, f32::NAN], 100.0);
        assert_eq!(values[..4], [99.0, 100.0, 112.5, 125.0]);
        assert!(values[4].is_nan());
        assert_eq!(flags.iter().map(|flags| flags.bits() >> 5).collect::<Vec<_>>(), [0, 0, 1, 1, 0]);
        // Second order of the exponential: 1 − ε/2 after a step of ε (M − c).
        let (step, cutoff) = (0.01f32, 100.0f32);
        let slope = (compressed(cutoff + step, cutoff) - cutoff) / (cutoff + step - cutoff);
        // An f32 at 100 has 8e-6: 8e-4 of the step.
        assert!((slope - 1.0).abs() < 2e-3, "{slope}");
    }

    proptest! {
        #[test]
        fn order_and_bound_hold_and_what_is_below_stays(
            cutoff in prop_oneof![0.1f32..1e4, 1e-30f32..1e30],
            parts in prop::collection::vec(prop_oneof![0.0f32..1.0, 1.0f32..1.3, 1.0f32..30.0], 2..60),
        ) {
            let mut values: Vec<f32> = parts.iter().map(|part| part * cutoff).collect();
            values.sort_by(f32::total_cmp);
            let (compressed, flags) = knee(values.clone(), cutoff);
            let largest = (1.25 * f64::from(cutoff)) as f32;
            for (i, &x) in values.iter().enumerate() {
                prop_assert!(compressed[i] <= largest && compressed[i] <= x);
                prop_assert_eq!(flags[i].contains(PixelFlags::SPECULAR), x > cutoff);
                prop_assert!(x > cutoff || compressed[i] == x);
            }
            for (x, y) in values.windows(2).zip(compressed.windows(2)) {
                prop_assert!(y[0] <= y[1], "{:?} became {:?}", x, y);
                // The slope at the upper value, e^{−u}, leaves at least this step; two ulp of f32 must show.
                let room = 0.25 * f64::from(cutoff);
                let slope = (-(f64::from(x[1]) - f64::from(cutoff)).max(0.0) / room).exp();
                let step = slope * (f64::from(x[1]) - f64::from(x[0]));
                let visible = step > 2.0 * f64::from(f32::EPSILON) * f64::from(largest);
                prop_assert!(!visible || y[0] < y[1], "{:?} became {:?}", x, y);
            }
        }

        #[test]
        fn neighbouring_values_never_change_places(cutoff in 0.5f32..2e3, part in 1.0f32..6.0) {
            let mut x = (part * cutoff).max(cutoff);
            for _ in 0..64 {
                let next = x.next_up();
                prop_assert!(compressed(x, cutoff) <= compressed(next, cutoff), "{}", x);
                x = next;
            }
        }
    }
}
