//! What can go wrong in an experiment.

use std::path::PathBuf;

use isolux::calibrate::{CalibrateError, MeasureError};
use isolux::standardize::{PlanError, StandardizeError};
use isolux_camera::CameraError;
use isolux_pipeline::PipelineError;

/// Why an experiment failed. On simulated cameras each of these would be a defect.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ExperimentError {
    /// The simulated camera.
    #[error("simulated camera: {0}")]
    Camera(#[from] CameraError),
    /// The fits.
    #[error("calibration: {0}")]
    Calibrate(#[from] CalibrateError),
    /// A frame of a sweep.
    #[error("calibration: {0}")]
    Measure(#[from] MeasureError),
    /// A recording or simulated frames on their way to a result.
    #[error(transparent)]
    Pipeline(#[from] PipelineError),
    /// The chain.
    #[error("plan: {0}")]
    Plan(#[from] PlanError),
    /// A frame.
    #[error("standardize: {0}")]
    Standardize(#[from] StandardizeError),
    /// A bracket.
    #[error("merge: {0}")]
    Merge(#[from] isolux::standardize::MergeError),
    /// Planes that do not fit together.
    #[error("shape: {0}")]
    Shape(#[from] isolux::ShapeError),
    /// A scene without what the experiment looks for.
    #[error("scene `{scene}`: {missing} expected")]
    Scene {
        /// The scene.
        scene: &'static str,
        /// What is not there.
        missing: &'static str,
    },
    /// A folder without a recording that has a figure.
    #[error("`{}`: no recording found that has a figure, {expected} expected", folder.display())]
    NoRecording {
        /// The folder.
        folder: PathBuf,
        /// Names of recordings that have figures.
        expected: String,
    },
    /// A recording of a real camera without its intrinsics.
    #[error("`{recording}`: no intrinsics found in its recording.json, {{fx, fy, cx, cy}} expected")]
    NoIntrinsics {
        /// The recording.
        recording: String,
    },
    /// A detector of the image library refused its input.
    #[error("image library: {0}")]
    Detector(String),
}
