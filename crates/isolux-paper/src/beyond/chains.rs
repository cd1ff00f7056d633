//! The chains that are compared: the paper's, the textbook's, and ours.

use isolux::standardize::{DenoiseStep, DistanceStep, SpecularStep, TimeStep};
use isolux::{Calibration, Channels, Choice, DenoiseRule, Standardizer};

use crate::error::PaperError;

/// One chain, without a step for highlights.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Chain {
    /// As a table names it.
    pub name: &'static str,
    time: TimeStep,
    distance: DistanceStep,
    denoise: DenoiseStep,
}

const fn chain(name: &'static str, time: TimeStep, distance: DistanceStep) -> Chain {
    Chain { name, time, distance, denoise: DenoiseStep::None }
}

/// Nothing but the camera's image.
pub const RAW: Chain = chain("raw", TimeStep::None, DistanceStep::None);
/// What one writes in NumPy.
pub const TEXTBOOK: Chain = chain("A d²/t", TimeStep::Linear, DistanceStep::Square);
/// The paper's eq. 5 with linear time.
pub const EQ5: Chain = chain("eq. 5, linear time", TimeStep::Linear, DistanceStep::Eq5);
/// The paper's.
pub const PAPER: Chain = chain("the paper (lut, cubic)", TimeStep::Lut, DistanceStep::Cubic);
/// Ours.
pub const LUTB: Chain = Chain {
    denoise: DenoiseStep::Smooth(DenoiseRule::Wiener),
    ..chain("lut, wiener, spline", TimeStep::Lut, DistanceStep::Spline)
};
pub const BEST: Chain = Chain {denoise: DenoiseStep::Smooth(DenoiseRule::Wiener), ..chain("isolux (response, wiener, spline)", TimeStep::Response, DistanceStep::Spline)
};
/// Everybody.
pub const ALL: [Chain; 6] = [RAW, EQ5, TEXTBOOK, PAPER, LUTB, BEST];

impl Chain {
    /// Plans the chain for frames of a simulated camera.
    ///
    /// # Errors
    /// [`PaperError::Plan`] when the calibration lacks a term.
    pub fn plan(&self, calibration: &Calibration) -> Result<Standardizer, PaperError> {
        let choice = Choice {
            time: Some(self.time),
            distance: Some(self.distance),
            denoise: Some(self.denoise),
            specular: Some(SpecularStep::None),
            ..Choice::default()
        };
        let channels = Channels::AMPLITUDE | Channels::DISTANCE | Channels::INTEGRATION_TIME | Channels::INTENSITY | Channels::PHASE_SAMPLES;
        Ok(Standardizer::plan(&choice, Some(calibration), channels)?)
    }
}
