//! A folder of `.npy` files.

use std::fs::{self, File};
use std::path::{Path, PathBuf};

use super::channel::ArrayFile;
use super::stream::{Packing, Section};
use crate::error::{RecordingError, listing};

/// What a folder holds that matters to a recording.
pub(crate) struct Contents {
    /// Channel name and file, sorted by name.
    pub(crate) arrays: Vec<(String, PathBuf)>,
    /// True when there is a `recording.npz`.
    pub(crate) has_archive: bool,
    /// Some names of what else is there, for a message.
    pub(crate) others: String,
}

/// Looks through a folder, not through the folders in it. Hidden files are left alone: they are no channels but
/// what file managers leave behind.
pub(crate) fn list(folder: &Path) -> Result<Contents, RecordingError> {
    let (mut arrays, mut others) = (Vec::new(), Vec::new());
    for entry in fs::read_dir(folder).map_err(RecordingError::io("list", folder))? {
        let path = entry.map_err(RecordingError::io("list", folder))?.path();
        let name = path.file_name().unwrap_or_default();
        let text = name.to_string_lossy();
        if text.starts_with('.') {
            continue;
        }
        match (text.strip_suffix(".npy"), name.to_str()) {
            (Some(stem), Some(_)) => arrays.push((stem.to_owned(), path)),
            (Some(_), None) => {
                return Err(RecordingError::content(
                    &path,
                    "a file name that is not UTF-8",
                    "a channel's name",
                ));
            }
            (None, _) => others.push(text.into_owned()),
        }
    }
    arrays.sort();
    others.sort();
    let has_archive = others.iter().any(|name| name == "recording.npz");
    others.truncate(5);
    Ok(Contents { arrays, has_archive, others: listing(others.iter().map(String::as_str)) })
}

/// Opens the arrays and reads their headers.
pub(crate) fn open_arrays(arrays: Vec<(String, PathBuf)>) -> Result<Vec<ArrayFile>, RecordingError> {
    arrays.into_iter().map(|(name, path)| open_array(name, path)).collect()
}

fn open_array(name: String, path: PathBuf) -> Result<ArrayFile, RecordingError> {
    let metadata = fs::metadata(&path).map_err(RecordingError::io("open", &path))?;
    // Asked before opening: to open a named pipe would wait for its other end.
    if !metadata.is_file() {
        let found = if metadata.is_dir() { "a folder" } else { "a device or pipe" };
        return Err(RecordingError::content(&path, found, "a .npy file"));
    }
    let file = File::open(&path).map_err(RecordingError::io("open", &path))?;
    let bytes = metadata.len();
    let section = Section { start: 0, stored_bytes: bytes, bytes, packing: Packing::Plain };
    ArrayFile::open(name, path, file, section)
}
