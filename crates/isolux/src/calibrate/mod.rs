//! From recordings to a [`Calibration`](crate::Calibration): measure sweeps frame by frame, then fit the terms they determine.

mod distance_sweep;
mod error;
mod evidence;
mod exposure_sweep;
mod factors;
mod fit;
pub mod joint;
mod noise_survey;
mod response;
mod runs;
pub mod scene;
mod target;
mod warning;
mod window;

pub use distance_sweep::{DistanceSweep, ReferenceDecays};
pub use error::CalibrateError;
pub use evidence::ResponseEvidence;
pub use exposure_sweep::{ExposureCurve, ExposureSweep};
pub use fit::{ExposureFit, FitReport, Measurements, fit};
pub use noise_survey::{NoiseCells, NoiseSurvey};
pub use scene::{CameraMotion, MotionFinding, MotionScout, SceneObservations, SceneReport, SceneSweep};
pub use target::{SurfaceUse, TargetReport, TargetSweep, TargetWindows, label_windows};
pub use warning::FitWarning;

use crate::calibration::{NoiseFloor, Reference};
use crate::frame::IntegrationTime;
use crate::terms::cubic::Scaling;

/// What the user decides about a calibration.
#[derive(Clone, Debug, PartialEq)]
pub struct CalibrateSettings {
    /// Conditions under which every multiplier is 1.
    pub reference: Reference,
    /// Side of the central measurement window of a distance sweep, pixels; 20 in the paper.
    pub window_px: usize,
    /// Frames dropped after each change of the integration time; 50 in the paper.
    pub skip_frames: usize,
    /// Integration times to leave out, µs.
    pub exclude_time_us: Vec<f64>,
    /// Modulation frequency of the sweeps, Hz, where it is known: the spline then allows for the aliased harmonic, and
    /// the response of the raw bins repairs the distance.
    pub modulation_frequency_hz: Option<f64>,
}

impl Default for CalibrateSettings {
    fn default() -> Self {
        Self {
            reference: Reference::default(),
            window_px: 20,
            skip_frames: 0,
            exclude_time_us: Vec::new(),
            modulation_frequency_hz: None,
        }
    }
}

impl CalibrateSettings {
    /// A time is excluded when it equals one of the list to 0.01 %, more than f32 rounding and less than any
    /// camera's step.
    fn excludes(&self, integration_time_us: f64) -> bool {
        let same = |excluded: &f64| (integration_time_us / excluded - 1.0).abs() < 1e-4;
        self.exclude_time_us.iter().any(same)
    }
}

/// The one time of a frame; an error message's words where there is none.
fn single_time(time: &IntegrationTime) -> Result<f64, &'static str> {
    match time {
        IntegrationTime::PerFrame(time) => Ok(*time),
        IntegrationTime::Unknown => Err("unknown"),
        IntegrationTime::PerPixel(_) => Err("a map with a time for each pixel"),
    }
}

impl Scaling {
    /// In words, for reports.
    #[must_use]
    pub fn describe(self) -> &'static str {
        match self {
            Self::AtReference => "normalized at the reference distance",
            Self::OntoOthers => "scaled onto the others",
            Self::LeftOut => "left out",
        }
    }
}

/// The noise floor that a measured deviation stands for; none where quantization hides it.
fn noise_floor(deviation_dn: Option<f64>, integration_time_us: f64) -> Option<NoiseFloor> {
    deviation_dn.filter(|sd| *sd > 0.0 && sd.is_finite()).map(|sd| NoiseFloor::new(sd, integration_time_us))
}
