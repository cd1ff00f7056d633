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
    exit_code: u8,
}

/// What commands return.
pub(crate) type Outcome<T = ()> = Result<T, Failure>;

impl Failure {
    /// Exit code after Ctrl-C, as shells have it.
    pub(crate) const INTERRUPTED: u8 = 130;

    /// The user has stopped the command.
    pub(crate) fn interrupted() -> Self {
        Self { message: "interrupted; nothing was written".to_owned(), exit_code: Self::INTERRUPTED }
    }

    /// The data are bad.
    pub(crate) fn data(message: impl Display) -> Self {
        Self { message: message.to_string(), exit_code: 1 }
    }

    /// The call is bad.
    pub(crate) fn usage(message: impl Display) -> Self {
        Self { message: message.to_string(), exit_code: 2 }
    }

    /// Bad data in a frame of a recording.
    pub(crate) fn frame(recording: &Path, frame: usize, message: impl Display) -> Self {
        Self::data(format!("`{}`, frame {frame}: {message}", recording.display()))
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

impl From<PlanError> for Failure {
    fn from(error: PlanError) -> Self {
        match error {
            PlanError::TermMissing { .. } | PlanError::ChannelMissing { .. } => Self::usage(error),
            _ => Self::data(error),
        }
    }
}
