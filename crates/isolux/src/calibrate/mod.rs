//! From recordings to a [`Calibration`](crate::Calibration): measure recordings frame by frame, then fit the terms that
//! they determine. [`ExposureFit`] tells the order of both.
//!
//! Each kind of recording has a room of its own: `exposure`, `distance`, `target` and `scene`, with how it is measured,
//! what is fitted to it and its warnings. Targets and scenes share one model, [`joint`].

mod distance;
mod error;
mod exposure;
mod factor_terms;
mod fit;
pub mod joint;
mod measure_error;
mod measurements;
mod report;
mod runs;
pub mod scene;
mod settings;
mod sweep_frames;
mod target;
mod warning;

pub use distance::{DistanceSweep, DistanceWarning, ReferenceDecays};
pub use error::CalibrateError;
pub use exposure::{
    ExposureCurve, ExposureSweep, ExposureWarning, MissingTier, NoiseCells, NoiseSurvey, ResponseEvidence,
};
pub use factor_terms::FactorWarning;
pub use fit::{ExposureFit, fit};
pub use measure_error::{MeasureError, UnlikeShapes};
pub use measurements::Measurements;
pub use report::FitReport;
pub use scene::{
    CameraMotion, MotionFinding, MotionScout, SceneObservations, SceneReport, SceneSweep, SceneWarning,
};
pub use settings::CalibrateSettings;
pub use target::{
    SurfaceUse, TargetError, TargetReport, TargetSweep, TargetWarning, TargetWindows, label_windows,
};
pub use warning::FitWarning;
