//! The pixels of a frame that are measurements.

use crate::frame::{PixelFlags, Shape};

/// One frame's distances and amplitudes. A distance is NaN where the pixel does not count.
#[derive(Clone, Copy)]
pub(super) struct Image<'a> {
    pub(super) shape: Shape,
    pub(super) distance_m: &'a [f32],
    pub(super) amplitude: &'a [f32],
}

/// The distances of the pixels that count, NaN elsewhere.
pub(super) fn measured(amplitude: &[f32], distance_m: &[f32], flags: &[PixelFlags], out: &mut [f32]) {
    for (((out, &d), &a), flags) in out.iter_mut().zip(distance_m).zip(amplitude).zip(flags) {
        let positive = (d > 0.0) & (d < f32::INFINITY) & (a > 0.0) & (a < f32::INFINITY);
        *out = if positive & !flags.contains(PixelFlags::INVALID) { d } else { f32::NAN };
    }
}

/// Gives pixels that did not count the delivered distance.
pub(super) fn keep_the_rest(out: &mut [f32], distance_m: &[f32]) {
    for (out, &delivered) in out.iter_mut().zip(distance_m) {
        *out = if out.is_nan() { delivered } else { *out };
    }
}
