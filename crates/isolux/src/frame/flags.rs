//! Flags of pixels.

use bitflags::bitflags;

bitflags! {
    /// Reasons to distrust a pixel; no bit set means that the value may be used.
    ///
    /// A standardized amplitude is NaN exactly where [`PixelFlags::INVALID`] is set. The other bits say why, or
    /// warn that a value is less reliable. The bit positions are part of the recording format and never change.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
    pub struct PixelFlags: u16 {
        /// Nothing usable was measured, or a step could not be applied: the value is NaN.
        const INVALID = 1 << 0;
        /// The pixel was driven into saturation; with INVALID where the camera delivered a code, not a value.
        const SATURATED = 1 << 1;
        /// The amplitude is so close to the noise floor that its mean is biased upwards.
        const LOW_SIGNAL = 1 << 2;
        /// The integration time lies outside the calibrated range.
        const TIME_OUT_OF_RANGE = 1 << 3;
        /// The distance lies outside the calibrated range; the value continues with the slope of d².
        const DISTANCE_OUT_OF_RANGE = 1 << 4;
        /// The value was limited as a specular highlight.
        const SPECULAR = 1 << 5;
        /// The pixel lies outside the supported part of the illumination profile, or its surface is steeper than
        /// the angle term was fitted on; the nearest known factor is used.
        const ILLUMINATION_OUT_OF_RANGE = 1 << 6;
        /// A brighter surface that saturates would deliver the same amplitude at this distance and time; with INVALID.
        const AMBIGUOUS = 1 << 7;
    }
}

impl PixelFlags {
    /// These flags or none, without a branch.
    #[inline(always)]
    pub(crate) fn when(self, set: bool) -> Self {
        Self::from_bits_retain(u16::from(set) * self.bits())
    }

    /// Name and bit position of every flag, as recordings carry them.
    pub fn legend() -> impl Iterator<Item = (&'static str, u32)> {
        Self::all().iter_names().map(|(name, flag)| (name, flag.bits().trailing_zeros()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_bits_are_those_of_the_recording_format() {
        let legend: Vec<_> = PixelFlags::legend().collect();
        let expected = [
            ("INVALID", 0),
            ("SATURATED", 1),
            ("LOW_SIGNAL", 2),
            ("TIME_OUT_OF_RANGE", 3),
            ("DISTANCE_OUT_OF_RANGE", 4),
            ("SPECULAR", 5),
            ("ILLUMINATION_OUT_OF_RANGE", 6),
            ("AMBIGUOUS", 7),
        ];
        assert_eq!(legend, expected);
    }
}
