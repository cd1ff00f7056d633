//! Which files of a path make the recording.

use std::path::{Path, PathBuf};

use super::channel::ArrayFile;
use super::{archive, folder};
use crate::error::RecordingError;

/// The arrays of the recording at `path`, by name, and where its `recording.json` would be.
pub(super) fn find_arrays(path: &Path) -> Result<(Vec<ArrayFile>, PathBuf), RecordingError> {
    let metadata = std::fs::metadata(path).map_err(RecordingError::io("open", path))?;
    let not = |found: String| RecordingError::NotARecording { path: path.to_owned(), found };
    if metadata.is_dir() {
        let contents = folder::list(path)?;
        return match (contents.arrays.is_empty(), contents.has_archive) {
            (false, false) => Ok((folder::open_arrays(contents.arrays)?, path.join("recording.json"))),
            (true, true) => {
                Ok((archive::open_arrays(&path.join("recording.npz"))?, path.join("recording.json")))
            }
            (false, true) => {
                Err(not("both .npy files and recording.npz; move one of the two away".to_owned()))
            }
            (true, false) => Err(not(format!("a folder with {}", contents.others))),
        };
    }
    if !metadata.is_file() {
        return Err(not("neither a file nor a folder".to_owned()));
    }
    match path.extension().and_then(|extension| extension.to_str()) {
        Some("npz") => Ok((archive::open_arrays(path)?, path.with_extension("json"))),
        Some("npy" | "json") => Err(not("one file of a recording; give its folder".to_owned())),
        _ => Err(not("a file without .npz at the end of its name".to_owned())),
    }
}
