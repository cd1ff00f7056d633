//! What a plan must know about the recording.

use super::AmbientLight;
use crate::common_factor::RelativeExposure;
use crate::frame::{Channels, Intrinsics, Shape};

/// Facts about a recording that decide which steps are possible.
#[derive(Clone, Debug, PartialEq)]
pub struct RecordingTraits {
    /// The channels that the recording has.
    pub channels: Channels,
    /// Height and width of its frames in pixels, where they are known before the first frame.
    pub shape: Option<Shape>,
    /// Its intrinsics, pixels; the angle step needs them.
    pub intrinsics: Option<Intrinsics>,
    /// Its modulation frequency, Hz, from which the prediction of sigma computes the noise of the distances.
    /// `None`: the noise is estimated from each frame.
    pub modulation_frequency_hz: Option<f64>,
    /// Its ambient light, without which the response cannot tell the fill of a pixel from amplitude and distance.
    /// [`AmbientSurvey`](crate::calibrate::AmbientSurvey) estimates it.
    pub ambient_light: Option<AmbientLight>,
    /// What its frames have relative to each other, which the step `relative` takes out. An
    /// [`ExposureSurvey`](super::ExposureSurvey) of all frames finds it.
    pub relative_exposure: Option<RelativeExposure>,
}

/// The traits of a recording of which only the channels are known.
impl From<Channels> for RecordingTraits {
    fn from(channels: Channels) -> Self {
        Self {
            channels,
            shape: None,
            intrinsics: None,
            modulation_frequency_hz: None,
            ambient_light: None,
            relative_exposure: None,
        }
    }
}
