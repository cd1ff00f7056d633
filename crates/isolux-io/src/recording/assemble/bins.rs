//! Phase samples: brought into the paper's order and sign, and looked through for clipped ones.

use isolux::{PhaseConvention, PixelFlags, Plane, Shape};

use crate::recording::source::RawFrame;

/// Reads four phase samples, number `set` of `sets` in the frame, into `slot`, whose memory is reused.
pub(super) fn read(
    frame: &RawFrame<'_>,
    shape: Shape,
    sets: usize,
    set: usize,
    convention: PhaseConvention,
    slot: &mut Option<[Plane<f32>; 4]>,
) {
    let bins = slot.get_or_insert_with(|| [(); 4].map(|()| Plane::filled(shape, f32::NAN)));
    let bin_bytes = frame.bytes.len() / (4 * sets);
    for (bin, position) in bins.iter_mut().zip(convention.positions()) {
        bin.reshape(shape, f32::NAN);
        let place = 4 * set + position;
        let bytes = &frame.bytes[place * bin_bytes..(place + 1) * bin_bytes];
        RawFrame { bytes, ..*frame }.read_f32(bin.values_mut());
    }
}

/// Marks the pixels with a sample at `level` or beyond. The samples of cameras that deliver differences of two readings
/// are signed and clip at −`level` too; those of others are never that low.
pub(super) fn flag_clipped(samples: &[Plane<f32>], level: f32, flags: &mut Plane<PixelFlags>) {
    for sample in samples {
        for (flags, &value) in flags.values_mut().iter_mut().zip(sample.values()) {
            flags.set(PixelFlags::SATURATED, value.abs() >= level || flags.contains(PixelFlags::SATURATED));
        }
    }
}
