//! What a plan must know about the recording.

use super::AmbientLight;
use crate::common_factor::RelativeExposure;
use crate::frame::{Channels, Lens, Shape};

/// Facts about a recording that decide which steps are possible.
#[derive(Clone, Debug, PartialEq)]
pub struct RecordingTraits {
    /// The channels that the recording has.
    pub channels: Channels,
    /// Height and width of its frames in pixels, where they are known before the first frame.
    pub shape: Option<Shape>,
    /// The lens of its camera; the angle step needs it and, unless it is a pinhole, the shape.
    pub lens: Option<Lens>,
    /// Its modulation frequency, Hz, from which the prediction of sigma computes the noise of the distances.
    /// `None`: the noise is estimated from each frame.
    pub modulation_frequency_hz: Option<f64>,
    /// Its ambient light, without which the response cannot tell the fill of a pixel from amplitude and distance.
    /// [`AmbientSurvey`](crate::calibrate::AmbientSurvey) estimates it.
    pub ambient_light: Option<AmbientLight>,
    /// What its frames have relative to each other, which the step `relative` takes out. An
    /// [`ExposureSurvey`](super::ExposureSurvey) of all frames finds it.
    pub relative_exposure: Option<RelativeExposure>,
    /// Name of its camera.
    pub camera: Option<String>,
    /// What its amplitudes no longer show, because something upstream has taken it out.
    pub already: AlreadyCorrected,
}

/// Effects that are no longer in the amplitudes of a recording. [`Inspector`](crate::inspect::Inspector) finds them out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct AlreadyCorrected {
    /// The integration time.
    pub time: bool,
    /// The distance.
    pub distance: bool,
}

/// The traits of a recording of which only the channels are known.
impl From<Channels> for RecordingTraits {
    fn from(channels: Channels) -> Self {
        Self {
            channels,
            shape: None,
            lens: None,
            modulation_frequency_hz: None,
            ambient_light: None,
            relative_exposure: None,
            camera: None,
            already: AlreadyCorrected::default(),
        }
    }
}
