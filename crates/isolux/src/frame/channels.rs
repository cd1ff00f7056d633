//! The channels that a frame or a recording may carry, as a set.

use bitflags::bitflags;

bitflags! {
    /// The channels that a frame or a recording may carry.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
    pub struct Channels: u16 {
        /// Amplitude, eq. 1 of the paper, in digital numbers.
        const AMPLITUDE = 1 << 0;
        /// Radial distance.
        const DISTANCE = 1 << 1;
        /// Integration time, per frame or per pixel.
        const INTEGRATION_TIME = 1 << 2;
        /// The four raw bins A1..A4.
        const PHASE_SAMPLES = 1 << 3;
        /// DC image.
        const INTENSITY = 1 << 4;
        /// Time stamp.
        const TIMESTAMP = 1 << 5;
        /// Labels for calibration.
        const TARGET = 1 << 6;
        /// Amplitude as the vendor scaled it.
        const VENDOR_AMPLITUDE = 1 << 7;
        /// Confidence as the vendor delivered it.
        const VENDOR_CONFIDENCE = 1 << 8;
        /// Pose of the camera.
        const POSE = 1 << 9;
    }
}
