//! How a command ends when it fails: one message, and the exit code of `product` behaviour: 1 bad data, 2 bad
//! usage.

use std::fmt::Display;
use std::process::ExitCode;

use isolux::standardize::PlanError;
use isolux_experiments::ExperimentError;
use isolux_pipeline::PipelineError;

use crate::advice;

/// A failed command.
#[derive(Debug, thiserror::Error)]
#[error("{message}")]
pub(crate) struct Failure {
    message: String,
    exit_code: u8,
}

/// What commands return.
pub(crate) type Outcome<T = ()> = Result<T, Failure>;

impl Failure {
    /// Exit code after Ctrl-C, as shells have it.
    pub(crate) const INTERRUPTED: u8 = 130;

    /// The data are bad.
    pub(crate) fn data(message: impl Display) -> Self {
        Self { message: message.to_string(), exit_code: 1 }
    }

    /// The call is bad.
    pub(crate) fn usage(message: impl Display) -> Self {
        Self { message: message.to_string(), exit_code: 2 }
    }

    /// The process's exit code.
    pub(crate) fn exit_code(&self) -> ExitCode {
        ExitCode::from(self.exit_code)
    }
}

impl From<isolux_io::RecordingError> for Failure {
    fn from(error: isolux_io::RecordingError) -> Self {
        Self::data(error)
    }
}

impl From<isolux_io::CalibrationFileError> for Failure {
    fn from(error: isolux_io::CalibrationFileError) -> Self {
        Self::data(error)
    }
}

impl From<isolux_camera::CameraError> for Failure {
    fn from(error: isolux_camera::CameraError) -> Self {
        Self::data(error)
    }
}

impl From<PipelineError> for Failure {
    fn from(error: PipelineError) -> Self {
        Self { message: advice::with(&error, error.advice()), exit_code: exit_code(&error) }
    }
}

impl From<ExperimentError> for Failure {
    fn from(error: ExperimentError) -> Self {
        match error {
            ExperimentError::Pipeline(error) => error.into(),
            error => Self::data(error),
        }
    }
}

/// Bad usage is what another call could do with the same data.
fn exit_code(error: &PipelineError) -> u8 {
    match error {
        PipelineError::Interrupted => Failure::INTERRUPTED,
        PipelineError::Plan(
            PlanError::TermMissing { .. }
            | PlanError::CalibrationMissing { .. }
            | PlanError::ChannelMissing { .. },
        )
        | PipelineError::BracketTime { .. }
        | PipelineError::NoBrackets { .. }
        | PipelineError::Merge { .. }
        | PipelineError::ChannelKept { .. }
        | PipelineError::KeptOfMerged => 2,
        _ => 1,
    }
}
