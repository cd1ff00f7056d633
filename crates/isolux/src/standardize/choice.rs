//! What the user asks for: a method, and single steps that override it.

use crate::denoise::DenoiseRule;
use crate::frame::{Channels, Intrinsics, Shape};
use crate::specular::SpecularRule;
use crate::terms::NoiseModel;
use crate::terms::response::ResponseTier;

/// Which terms to use where no single step says otherwise.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Method {
    /// The paper's chain: lut, cubic, histogram. All must be in the calibration.
    Paper,
    /// The best terms that the calibration holds; without a calibration, textbook physics.
    #[default]
    Best,
}

/// The step that takes the integration time out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum TimeStep {
    /// The calibration's table.
    Lut,
    /// The calibration's fill-level response, then `t_ref / t`.
    Response,
    /// `t_ref / t`.
    Linear,
    /// Leave it in.
    None,
}

/// The step that denoises the distance before it scales.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum DenoiseStep {
    /// By this rule.
    Smooth(DenoiseRule),
    /// Scale by the distance as it was delivered.
    None,
}

/// The step that takes the distance out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum DistanceStep {
    /// The calibration's cubic.
    Cubic,
    /// The calibration's smooth law.
    Spline,
    /// `(d / d_ref)²`.
    Square,
    /// Eq. 5 of the paper.
    Eq5,
    /// Leave it in.
    None,
}

/// The step that takes the illumination profile out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ProfileStep {
    /// The calibration's profile.
    On,
    /// Leave it in.
    Off,
}

/// The step that takes the angle of incidence out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AngleStep {
    /// The calibration's exponent of the cosine; Lambert's where it holds none.
    On,
    /// Leave it in.
    Off,
}

/// The step that limits highlights.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SpecularStep {
    /// Limit by this rule.
    Limit(SpecularRule),
    /// Leave them.
    None,
}

/// Whether the standard deviation of each value is predicted. Where it is, the bias that the noise of the distance
/// brings is taken off the values.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SigmaStep {
    /// It is an error when the noise is not known.
    Required,
    /// Where the choice or the calibration knows the noise.
    WhereKnown,
    /// Not at all.
    #[default]
    None,
}

/// A method, and the steps that override it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Choice {
    /// Where no single step is given.
    pub method: Method,
    /// Integration time.
    pub time: Option<TimeStep>,
    /// Tier of the response; otherwise the best that calibration and recording allow.
    pub response_tier: Option<ResponseTier>,
    /// Noise of the distance; otherwise it is left in.
    pub denoise: Option<DenoiseStep>,
    /// Distance.
    pub distance: Option<DistanceStep>,
    /// Illumination profile.
    pub profile: Option<ProfileStep>,
    /// Angle of incidence; otherwise it is left in.
    pub angle: Option<AngleStep>,
    /// Highlights.
    pub specular: Option<SpecularStep>,
    /// Amplitudes below this are flagged LOW_SIGNAL, DN; otherwise the calibration's noise floor decides.
    pub low_signal_below_dn: Option<f32>,
    /// Prediction of the standard deviation.
    pub sigma: SigmaStep,
    /// Noise of the amplitude, for the prediction; otherwise the calibration's.
    pub noise: Option<NoiseModel>,
    /// Modulation frequency of the recording, Hz, for the prediction; otherwise the noise of the distances is
    /// estimated from each frame.
    pub modulation_frequency_hz: Option<f64>,
}

/// What a plan must know of the recording that it is for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stream {
    /// Channels that it has.
    pub channels: Channels,
    /// Height and width of its frames, where they are known beforehand.
    pub shape: Option<Shape>,
    /// Its intrinsics, which the angle step needs.
    pub intrinsics: Option<Intrinsics>,
}

impl From<Channels> for Stream {
    fn from(channels: Channels) -> Self {
        Self { channels, shape: None, intrinsics: None }
    }
}
