//! The list of formats.

use std::path::Path;

use super::assemble::Assembled;
use super::native::NativeSource;
use super::reading::Recording;
use crate::error::RecordingError;

/// Opens the recording at `path`, whatever its format.
///
/// # Errors
/// [`RecordingError::NotARecording`] for a path that holds none; otherwise what does not fit, by file.
pub fn open(path: &Path) -> Result<Box<dyn Recording>, RecordingError> {
    // A further format asks here whether `path` is one of its own.
    Ok(Box::new(Assembled::new(NativeSource::open(path)?)?))
}
