//! The list of formats.

use std::path::Path;

use super::native;
use super::reading::Recording;
use crate::error::RecordingError;

/// Opens a recording of one format; `None` for a path that is none of its own.
type Open = fn(&Path) -> Result<Option<Box<dyn Recording>>, RecordingError>;

/// Tried in this order. The native format stands last: it takes every path, and says what is wrong with one that
/// holds no recording.
const FORMATS: &[Open] = &[native::open];

/// Opens the recording at `path`, whatever its format.
///
/// # Errors
/// [`RecordingError::NotARecording`] for a path that holds none; otherwise what does not fit, by file.
pub fn open(path: &Path) -> Result<Box<dyn Recording>, RecordingError> {
    for open in FORMATS {
        if let Some(recording) = open(path)? {
            return Ok(recording);
        }
    }
    Err(RecordingError::NotARecording {
        path: path.to_owned(),
        found: "a path of no known format".to_owned(),
    })
}
