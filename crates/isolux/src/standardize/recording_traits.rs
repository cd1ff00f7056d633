//! What a plan must know of the recording that it is for.

use crate::frame::Channels;
use crate::frame::Intrinsics;
use crate::frame::Shape;

/// Facts about a recording. They are no choice: the recording has them or it has not.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RecordingTraits {
    /// Channels that it has.
    pub channels: Channels,
    /// Height and width of its frames, where they are known beforehand.
    pub shape: Option<Shape>,
    /// Its intrinsics, which the angle step needs.
    pub intrinsics: Option<Intrinsics>,
    /// Its modulation frequency, Hz, for the prediction of sigma; otherwise the noise of the distances is estimated from
    /// each frame.
    pub modulation_frequency_hz: Option<f64>,
}

/// Of a recording of which nothing but its channels is known.
impl From<Channels> for RecordingTraits {
    fn from(channels: Channels) -> Self {
        Self { channels, shape: None, intrinsics: None, modulation_frequency_hz: None }
    }
}
