//! What the user asks for: a method, and single steps that override it.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

use crate::denoise::DenoiseRule;
use crate::frame::Channels;
use crate::names::{UnknownName, by_name};
use crate::specular::{RuleError, SpecularRule};
use crate::step_names::{AngleStep, DistanceStep, Method, ProfileStep, SigmaStep, TimeStep};
use crate::terms::NoiseModel;
use crate::terms::response::ResponseTier;

/// The step that denoises the distance before it scales.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum DenoiseStep {
    /// Smooth the distance by this rule.
    Smooth(DenoiseRule),
    /// Scale by the distance as it was delivered.
    None,
}

/// The step that limits highlights.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SpecularStep {
    /// Limit by this rule.
    Limit(SpecularRule),
    /// Leave highlights as they are.
    None,
}

/// The name of a step that does nothing.
const NONE: &str = "none";

impl fmt::Display for DenoiseStep {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Smooth(rule) => rule.fmt(f),
            Self::None => f.pad(NONE),
        }
    }
}

impl FromStr for DenoiseStep {
    type Err = UnknownName;

    fn from_str(text: &str) -> Result<Self, UnknownName> {
        match text {
            NONE => Ok(Self::None),
            text => text.parse().map(Self::Smooth).map_err(|error: UnknownName| error.or(NONE)),
        }
    }
}

impl fmt::Display for SpecularStep {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Limit(rule) => rule.fmt(f),
            Self::None => f.pad(NONE),
        }
    }
}

impl FromStr for SpecularStep {
    type Err = RuleError;

    fn from_str(text: &str) -> Result<Self, RuleError> {
        match text {
            NONE => Ok(Self::None),
            text => text.parse().map(Self::Limit).map_err(|error| match error {
                RuleError::Rule(error) => error.or(NONE).into(),
                error => error,
            }),
        }
    }
}

by_name!(DenoiseStep);
by_name!(SpecularStep);

/// A method, and the steps that override it. A step that is `None` follows the method.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Choice {
    /// What decides the steps that are not given.
    pub method: Method,
    /// How the integration time is removed.
    pub time: Option<TimeStep>,
    /// Tier of the response: by what it finds the fill of a pixel. `None` takes the best that calibration and
    /// recording allow.
    pub response_tier: Option<ResponseTier>,
    /// How the distance is denoised. `None` does not denoise it.
    pub denoise: Option<DenoiseStep>,
    /// How the distance is removed.
    pub distance: Option<DistanceStep>,
    /// Whether the illumination profile is removed.
    pub profile: Option<ProfileStep>,
    /// Whether the angle of incidence is removed. `None` leaves it in.
    pub angle: Option<AngleStep>,
    /// How highlights are limited.
    pub specular: Option<SpecularStep>,
    /// Amplitudes below this are flagged LOW_SIGNAL, DN; otherwise the calibration's noise floor decides.
    pub low_signal_below_dn: Option<f32>,
    /// Whether the standard deviation is predicted.
    pub sigma: SigmaStep,
    /// Noise of the amplitude, for the prediction; otherwise the calibration's.
    pub noise: Option<NoiseModel>,
}

impl Choice {
    /// The paper's chain.
    #[must_use]
    pub fn paper() -> Self {
        Self { method: Method::Paper, ..Self::default() }
    }

    /// Textbook physics for a recording with the `available` channels: `A d² / t`, without the factors whose
    /// channels are missing. Highlights stay.
    #[must_use]
    pub fn textbook(available: Channels) -> Self {
        let time = available.contains(Channels::INTEGRATION_TIME);
        let distance = available.contains(Channels::DISTANCE);
        Self {
            time: Some(if time { TimeStep::Linear } else { TimeStep::None }),
            distance: Some(if distance { DistanceStep::Square } else { DistanceStep::None }),
            profile: Some(ProfileStep::Off),
            specular: Some(SpecularStep::None),
            ..Self::default()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::specular::PercentRule;

    #[test]
    fn a_choice_reads_back_from_its_json() {
        let choice = Choice {
            method: Method::Paper,
            time: Some(TimeStep::Response),
            response_tier: Some(ResponseTier::PhaseSamples),
            denoise: Some(DenoiseStep::Smooth(DenoiseRule::Wiener)),
            specular: Some(SpecularStep::Limit(SpecularRule::Percent(PercentRule::Quantile(0.9)))),
            sigma: SigmaStep::Required,
            ..Choice::default()
        };
        let json = serde_json::to_value(choice).unwrap();
        assert_eq!(json["specular"], "percent:quantile=0.9");
        assert_eq!((&json["denoise"], &json["response_tier"]), (&"wiener".into(), &"phase_samples".into()));
        assert_eq!(serde_json::from_value::<Choice>(json).unwrap(), choice);
        assert!(serde_json::from_str::<Choice>(r#"{"tim": "lut"}"#).is_err());
    }

    #[test]
    fn steps_that_do_nothing_have_a_name_too() {
        assert_eq!("none".parse(), Ok(DenoiseStep::None));
        assert_eq!("none".parse(), Ok(SpecularStep::None));
        let error = "nothing".parse::<DenoiseStep>().unwrap_err().to_string();
        assert_eq!(error, "denoising rule `nothing` found, median, wiener, plane, temporal or none expected");
        let error = "clip".parse::<SpecularStep>().unwrap_err().to_string();
        assert!(error.ends_with("percent, knee or none expected"), "{error}");
    }
}
