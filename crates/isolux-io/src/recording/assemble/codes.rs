//! Pixels whose stored value is a code: flagged, and without a measurement.

use isolux::{Frame, PixelFlags, Plane};

use crate::recording::codes::ChannelCodes;

/// Flags amplitudes that are codes: INVALID, and what the code means.
pub(super) fn amplitude(codes: &ChannelCodes, frame: &mut Frame) {
    if codes.is_empty() {
        return;
    }
    for (&value, flags) in frame.amplitude.values().iter().zip(frame.flags.values_mut()) {
        if let Some(meaning) = codes.meaning(value) {
            *flags |= PixelFlags::INVALID | meaning;
        }
    }
}

/// Takes away stored distances that are codes (NaN), and flags what they mean.
pub(super) fn distance(codes: &ChannelCodes, stored: &mut Plane<f32>, flags: &mut Plane<PixelFlags>) {
    if codes.is_empty() {
        return;
    }
    for (value, flags) in stored.values_mut().iter_mut().zip(flags.values_mut()) {
        if let Some(meaning) = codes.meaning(*value) {
            *value = f32::NAN;
            *flags |= meaning;
        }
    }
}
