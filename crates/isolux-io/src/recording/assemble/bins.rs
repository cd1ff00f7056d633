//! Phase samples: brought into the paper's order and sign, and looked through for clipped ones.

use isolux::{Channels, PhaseConvention, PixelFlags, Plane, phase};

use super::loaded::Loaded;
use crate::error::RecordingError;
use crate::recording::source::RawFrame;

/// Reads the phase samples into `slot`, whose memory is reused; false where there are none.
pub(super) fn read(loaded: &Loaded<'_>, slot: &mut Option<[Plane<f32>; 4]>) -> Result<bool, RecordingError> {
    let shape = loaded.metadata.shape;
    let Some(frame) = loaded.raw(Channels::PHASE_SAMPLES)? else { return Ok(false) };
    let bins = slot.get_or_insert_with(|| [(); 4].map(|()| Plane::filled(shape, f32::NAN)));
    let positions = positions(loaded.metadata.info.phase_convention.unwrap_or_default());
    let bin_bytes = frame.bytes.len() / 4;
    for (bin, position) in bins.iter_mut().zip(positions) {
        bin.reshape(shape, f32::NAN);
        let bytes = &frame.bytes[position * bin_bytes..(position + 1) * bin_bytes];
        RawFrame { bytes, ..frame }.read_f32(bin.values_mut());
    }
    Ok(true)
}

/// Where the paper's bins A1..A4 stand in the recording.
fn positions(convention: PhaseConvention) -> [usize; 4] {
    let [a1, a2, a3, a4] = convention.order;
    // The phase that runs the other way changes the sign of A2 − A4 and of nothing else.
    if convention.reversed { [a1, a4, a3, a2] } else { [a1, a2, a3, a4] }
}

/// Marks the pixels with a bin at `clip`, the value that bins cannot exceed.
pub(super) fn flag_clipped(bins: &[Plane<f32>; 4], clip: f32, flags: &mut Plane<PixelFlags>) {
    let level = clip * phase::CLIPPED_SHARE as f32;
    for bin in bins {
        for (flags, &value) in flags.values_mut().iter_mut().zip(bin.values()) {
            flags.set(PixelFlags::SATURATED, value >= level || flags.contains(PixelFlags::SATURATED));
        }
    }
}
