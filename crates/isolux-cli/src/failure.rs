//! How a command ends when it fails: one message, and the exit code of `product` behaviour: 1 bad data, 2 bad
//! usage.

use std::fmt::Display;
use std::path::Path;
use std::process::ExitCode;

use isolux::standardize::PlanError;

/// A failed command.
#[derive(Debug, thiserror::Error)]
#[error("{message}")]
pub(crate) struct Failure {
    message: String,
    usage: bool,
}

/// What commands return.
pub(crate) type Outcome<T = ()> = Result<T, Failure>;

impl Failure {
    /// The data are bad.
    pub(crate) fn data(message: impl Display) -> Self {
        Self { message: message.to_string(), usage: false }
    }

    /// The call is bad.
    pub(crate) fn usage(message: impl Display) -> Self {
        Self { message: message.to_string(), usage: true }
    }

    /// Bad data in a frame of a recording.
    pub(crate) fn frame(recording: &Path, frame: usize, message: impl Display) -> Self {
        Self::data(format!("`{}`, frame {frame}: {message}", recording.display()))
    }

    /// The process's exit code.
    pub(crate) fn exit_code(&self) -> ExitCode {
        ExitCode::from(if self.usage { 2 } else { 1 })
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

impl From<PlanError> for Failure {
    fn from(error: PlanError) -> Self {
        match error {
            PlanError::TermMissing { .. } | PlanError::ChannelMissing { .. } => Self::usage(error),
            _ => Self::data(error),
        }
    }
}
