//! The chains that are compared: the paper's, the textbook's, and ours.

use isolux::standardize::{AmbientLight, DenoiseStep, DistanceStep, SpecularStep, TimeStep};
use isolux::{Channels, Choice, DenoiseRule, RecordingTraits, Standardizer};

use super::held_out::HeldOut;
use crate::error::ExperimentError;

/// What a recording offers besides amplitude, distance and integration time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Evidence {
    /// Nothing.
    Amplitude,
    /// The DC image.
    Intensity,
    /// The raw bins.
    PhaseSamples,
}

/// One chain, without a step for highlights.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Chain {
    /// As a table names it.
    pub name: &'static str,
    /// What it may read.
    pub evidence: Evidence,
    steps: Steps,
}

/// Where the steps of a chain come from.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Steps {
    /// [`Choice::textbook`].
    Textbook,
    /// [`Choice::paper`].
    Paper,
    /// The textbook's, with another step for the distance.
    TextbookBut(DistanceStep),
    /// None.
    Nothing,
    /// The best for the time, the wiener rule and the spline.
    Ours,
}

const fn chain(name: &'static str, steps: Steps) -> Chain {
    Chain { name, evidence: Evidence::Amplitude, steps }
}

const fn ours(name: &'static str, evidence: Evidence) -> Chain {
    Chain { name, evidence, steps: Steps::Ours }
}

/// Nothing but the camera's image.
pub const RAW: Chain = chain("raw", Steps::Nothing);
/// What one writes in NumPy.
pub const TEXTBOOK: Chain = chain("A d²/t", Steps::Textbook);
/// The paper's eq. 5 with linear time.
pub const EQ5: Chain = chain("eq. 5, linear time", Steps::TextbookBut(DistanceStep::Eq5));
/// The paper's.
pub const PAPER: Chain = chain("the paper (lut, cubic)", Steps::Paper);
/// Ours for cameras that deliver no more than amplitude and distance.
pub const FROM_AMPLITUDE: Chain =
    ours("isolux, amplitude alone (response, wiener, spline)", Evidence::Amplitude);
/// Ours with the DC image.
pub const FROM_INTENSITY: Chain = ours("isolux, intensity (response, wiener, spline)", Evidence::Intensity);
/// Ours with the raw bins.
pub const FROM_BINS: Chain = ours("isolux, raw bins (response, wiener, spline)", Evidence::PhaseSamples);
/// Everybody.
pub const ALL: [Chain; 7] = [RAW, EQ5, TEXTBOOK, PAPER, FROM_AMPLITUDE, FROM_INTENSITY, FROM_BINS];

impl Chain {
    /// Whether it is one of ours.
    #[must_use]
    pub fn is_ours(&self) -> bool {
        [FROM_AMPLITUDE, FROM_INTENSITY, FROM_BINS].contains(self)
    }

    /// Plans the chain for frames of a held-out camera in this ambient light, where it is known, with the calibration
    /// that such recordings allow.
    ///
    /// # Errors
    /// [`ExperimentError::Plan`] when the calibration lacks a term.
    pub fn plan(
        &self,
        held_out: &HeldOut,
        ambient_light: Option<&AmbientLight>,
    ) -> Result<Standardizer, ExperimentError> {
        let (calibration, besides) = match self.evidence {
            Evidence::Amplitude => (&held_out.from_amplitude, Channels::empty()),
            Evidence::Intensity => (&held_out.calibration, Channels::INTENSITY),
            Evidence::PhaseSamples => (&held_out.calibration, Channels::PHASE_SAMPLES),
        };
        let channels = Channels::AMPLITUDE | Channels::DISTANCE | Channels::INTEGRATION_TIME | besides;
        let traits = RecordingTraits { ambient_light: ambient_light.cloned(), ..channels.into() };
        Ok(Standardizer::plan(&self.steps.choice(channels), Some(calibration), traits)?)
    }
}

impl Steps {
    /// The steps for frames with these channels; highlights are left alone.
    fn choice(self, channels: Channels) -> Choice {
        let textbook = Choice::textbook(channels);
        let choice = match self {
            Self::Textbook => textbook,
            Self::Paper => Choice::paper(),
            Self::TextbookBut(distance) => Choice { distance: Some(distance), ..textbook },
            Self::Nothing => {
                Choice { time: Some(TimeStep::None), distance: Some(DistanceStep::None), ..textbook }
            }
            Self::Ours => Choice {
                denoise: Some(DenoiseStep::Smooth(DenoiseRule::Wiener)),
                distance: Some(DistanceStep::Spline),
                ..Choice::default()
            },
        };
        Choice { specular: Some(SpecularStep::None), ..choice }
    }
}
