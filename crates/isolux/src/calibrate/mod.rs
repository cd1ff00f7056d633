//! Measures recordings frame by frame and fits the terms of a [`Calibration`](crate::Calibration) to them. The
//! order of the stages is at [`ExposureFit`].
//!
//! Each kind of recording has a sweep, into which frames are pushed, and a result, to which the terms are fitted:
//!
//! | recording | measured by | result | terms |
//! |---|---|---|---|
//! | still scene at several integration times | [`ExposureSweep`] | [`ExposureCurve`] | `lut`, `response`, `noise` |
//! | flat target at several distances | [`DistanceSweep`] | [`ReferenceDecays`] | `cubic`, `spline` |
//! | labelled materials in any pose | [`TargetSweep`] | [`TargetWindows`] | `spline`, `profile`, `angle` |
//! | ordinary recording | [`SceneSweep`] | [`SceneObservations`] | `lut`, `response`, `spline`, `profile`, `angle`, as far as absent |
//!
//! Targets and scenes are fitted with one model of time, distance, place and angle, [`joint`]. What a recording
//! does not determine becomes no term, but a [`FitWarning`].

mod ambient_light;
mod blocks;
mod distance;
mod drift;
mod error;
mod exposure;
mod factor_terms;
mod fit;
mod grouped_noise;
pub mod joint;
mod lag;
mod levels;
mod measure_error;
mod measurements;
mod report;
mod residual;
mod runs;
pub mod scene;
mod settings;
mod severity;
mod smooth_curve;
mod stray;
mod sweep_fault;
mod sweep_frames;
mod target;
mod verdict;
mod warning;

pub use ambient_light::{AmbientSurvey, AmbientUnknown};
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
pub use residual::{ResidualOf, TermResidual};
pub use scene::{
    CameraMotion, MotionFinding, MotionScout, SceneObservations, SceneReport, SceneSweep, SceneWarning,
};
pub use settings::CalibrateSettings;
pub use severity::Severity;
pub use sweep_fault::SweepFault;
pub use target::{
    SurfaceUse, TargetError, TargetReport, TargetSweep, TargetWarning, TargetWindows, label_windows,
};
pub use verdict::Verdict;
pub use warning::FitWarning;
