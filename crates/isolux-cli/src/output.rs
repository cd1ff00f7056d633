//! Where a command may write: never over what it reads, and over nothing that it would not have written itself.

use std::fs;
use std::path::{Path, PathBuf};

use isolux_io::{CalibrationFileError, read_calibration};

use crate::failure::{Failure, Outcome};

/// Refuses an output that is one of the inputs, lies inside one, or would replace an archive's `.json`: to write
/// there would spoil what the output is made from.
pub(crate) fn keep_clear_of<'a>(output: &Path, inputs: impl IntoIterator<Item = &'a Path>) -> Outcome {
    // Where the folder is not there, the writer says so.
    let Some(place) = place(output) else { return Ok(()) };
    let is_archive = place.extension().is_some_and(|extension| extension == "npz");
    let json = is_archive.then(|| place.with_extension("json"));
    for input in inputs {
        // Whoever opens the input says what is wrong with it.
        let Ok(path) = input.canonicalize() else { continue };
        let described_by = path.is_file().then(|| path.with_extension("json"));
        let spoilt = |target: &PathBuf| target.starts_with(&path) || Some(target) == described_by.as_ref();
        if spoilt(&place) || json.as_ref().is_some_and(spoilt) {
            return Err(Failure::usage(format!(
                "`{}` would spoil the input `{}`; an output outside of it expected",
                output.display(),
                input.display()
            )));
        }
    }
    Ok(())
}

/// Refuses to replace anything but a calibration, of whatever version, or an empty file.
pub(crate) fn expect_calibration_or_nothing(output: &Path) -> Outcome {
    let Ok(metadata) = fs::metadata(output) else { return Ok(()) };
    let found = match () {
        () if metadata.is_dir() => "a folder".to_owned(),
        // Asked before reading: a pipe would wait for its other end.
        () if !metadata.is_file() => "a device or pipe".to_owned(),
        () if metadata.len() == 0 => return Ok(()),
        () => match read_calibration(output) {
            Err(CalibrationFileError::Foreign { found, .. }) => found,
            _ => return Ok(()),
        },
    };
    let expected = "a calibration, or nothing, expected: name another output";
    Err(Failure::data(format!("`{}` will not be replaced: found {found}; {expected}", output.display())))
}

/// The absolute path of what is, or would be, at `path`.
fn place(path: &Path) -> Option<PathBuf> {
    path.canonicalize().ok().or_else(|| {
        let parent = path.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
        Some(parent.canonicalize().ok()?.join(path.file_name()?))
    })
}
