//! The point-wise loop: one pass over amplitude and distance, written so that the compiler vectorizes it.

use crate::frame::PixelFlags;
use crate::terms::DistanceGain;

/// Pixels per call of the loop: a few planes of this many f32 stay in the first-level cache.
pub(super) const BLOCK: usize = 1024;

/// One block of pixels before correction. All slices have the same length.
#[derive(Clone, Copy)]
pub(super) struct Block<'a> {
    pub(super) amplitude: &'a [f32],
    /// Distances, m; 1 everywhere when no step scales by the distance.
    pub(super) distance_m: &'a [f32],
    /// Product of all multipliers except the distance's polynomial; NaN where one is unknown.
    pub(super) gain: &'a [f32],
}

/// Applies the multipliers and completes the flags: `flags` holds what is known before, `out` is overwritten.
///
/// No FMA and no reassociation: the same bits on every instruction set. `multiversion` compiles the body for each
/// and chooses at run time.
#[multiversion::multiversion(targets("x86_64+avx512f+avx512bw+avx512vl+avx512dq", "x86_64+avx2"))]
pub(super) fn pointwise(
    block: Block<'_>,
    law: &DistanceGain,
    low_signal_below_dn: f32,
    out: &mut [f32],
    flags: &mut [PixelFlags],
) {
    let count = out.len();
    let (amplitude, distance_m, gain) =
        (&block.amplitude[..count], &block.distance_m[..count], &block.gain[..count]);
    let flags = &mut flags[..count];
    for i in 0..count {
        let (a, d) = (amplitude[i], distance_m[i]);
        let value = a * gain[i] * law.at(d);
        let measured = d > 0.0 && value > 0.0 && value < f32::INFINITY;
        let invalid = !measured | flags[i].contains(PixelFlags::INVALID);
        let outside = measured & ((d < law.min_m) | (d > law.max_m));
        let low = a < low_signal_below_dn;
        out[i] = if invalid { f32::NAN } else { value };
        flags[i] = flags[i].difference(PixelFlags::ILLUMINATION_OUT_OF_RANGE.when(invalid))
            | PixelFlags::INVALID.when(invalid)
            | PixelFlags::DISTANCE_OUT_OF_RANGE.when(outside)
            | PixelFlags::LOW_SIGNAL.when(low & !invalid);
    }
}

/// The flags that [`tally`] counts: pixels that have all of the first and none of the second.
pub(super) const TALLIES: [(PixelFlags, PixelFlags); 5] = [
    (PixelFlags::INVALID, PixelFlags::empty()),
    (PixelFlags::DISTANCE_OUT_OF_RANGE, PixelFlags::empty()),
    (PixelFlags::SPECULAR, PixelFlags::empty()),
    (PixelFlags::ILLUMINATION_OUT_OF_RANGE, PixelFlags::empty()),
    (PixelFlags::empty(), PixelFlags::INVALID.union(OUT_OF_RANGE)),
];

/// Pixels that a term was extrapolated to.
const OUT_OF_RANGE: PixelFlags = PixelFlags::TIME_OUT_OF_RANGE
    .union(PixelFlags::DISTANCE_OUT_OF_RANGE)
    .union(PixelFlags::ILLUMINATION_OUT_OF_RANGE);

/// Adds the counts of one block. They are kept in u16, the width of the flags, so that the loop vectorizes.
#[multiversion::multiversion(targets("x86_64+avx512f+avx512bw+avx512vl+avx512dq", "x86_64+avx2"))]
pub(super) fn tally(block: &[PixelFlags], totals: &mut [usize; TALLIES.len()]) {
    debug_assert!(block.len() <= usize::from(u16::MAX));
    for ((wanted, unwanted), total) in TALLIES.iter().zip(totals) {
        let is_one = |flags: &PixelFlags| flags.contains(*wanted) & !flags.intersects(*unwanted);
        let matches = block.iter().map(|flags| u16::from(is_one(flags)));
        *total += usize::from(matches.fold(0u16, u16::wrapping_add));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The same pixel in f64, step by step, as one would explain it.
    fn oracle(a: f32, d: f32, gain: f32, law: &DistanceGain, known: u16) -> (f64, PixelFlags) {
        let mut flags = PixelFlags::from_bits_retain(known);
        let (min, max) = (f64::from(law.min_m), f64::from(law.max_m));
        let distance = f64::from(d);
        let edge = if distance < min {
            min
        } else if distance > max {
            max
        } else {
            distance
        };
        let [c0, c1, c2, c3] = law.coefficients.map(f64::from);
        let polynomial = c0 + c1 * edge + c2 * edge.powi(2) + c3 * edge.powi(3);
        let value = f64::from(a) * f64::from(gain) * polynomial * (distance / edge).powi(2);
        if !(distance > 0.0 && distance.is_finite() && value > 0.0 && value.is_finite()) {
            flags |= PixelFlags::INVALID;
        } else if edge != distance {
            flags |= PixelFlags::DISTANCE_OUT_OF_RANGE;
        }
        (if flags.contains(PixelFlags::INVALID) { f64::NAN } else { value }, flags)
    }

    fn sample() -> impl Strategy<Value = (f32, f32, f32, u16)> {
        let amplitude = prop_oneof![8 => 0.1f32..1e5, 1 => Just(0.0), 1 => Just(f32::NAN)];
        let distance = prop_oneof![8 => 0.05f32..50.0, 1 => Just(0.0), 1 => Just(f32::NAN), 1 => Just(-1.0)];
        let gain = prop_oneof![9 => 0.01f32..100.0, 1 => Just(f32::NAN)];
        (amplitude, distance, gain, 0u16..4)
    }

    proptest! {
        #[test]
        fn the_fast_loop_equals_the_oracle(pixels in prop::collection::vec(sample(), 0..70)) {
            // Coefficients of one sign: no cancellation, each of the 9 operations costs half an ulp, and the
            // amplified ones (squares) twice that.
            let tolerance = 16.0 * f64::from(f32::EPSILON);
            let law = DistanceGain::between([0.1, 0.2, 1.5, 0.01], 0.5, 4.0);
            let column = |pick: fn(&(f32, f32, f32, u16)) -> f32| pixels.iter().map(pick).collect::<Vec<f32>>();
            let (amplitude, distance_m, gain) = (column(|p| p.0), column(|p| p.1), column(|p| p.2));
            let mut flags: Vec<_> = pixels.iter().map(|p| PixelFlags::from_bits_retain(p.3)).collect();
            let mut out = vec![0.0; pixels.len()];
            let block = Block { amplitude: &amplitude, distance_m: &distance_m, gain: &gain };
            pointwise(block, &law, 0.0, &mut out, &mut flags);
            for (i, &(a, d, gain, known)) in pixels.iter().enumerate() {
                let (value, expected) = oracle(a, d, gain, &law, known);
                prop_assert_eq!(flags[i], expected);
                prop_assert!(value.is_nan() == out[i].is_nan());
                prop_assert!(value.is_nan() || (f64::from(out[i]) / value - 1.0).abs() <= tolerance);
            }
        }
    }
}
