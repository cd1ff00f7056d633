//! The calibration file, `CAMERA.json`: written for people to read, strict when read.

use std::fs;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

use isolux::Calibration;
use isolux::terms::ParameterError;
use serde_json::Value;

use crate::whole_file::write_whole;

/// A calibration takes kilobytes; a larger file is something else.
const LONGEST_BYTES: u64 = 16 << 20;

/// Why a calibration file could not be read or written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CalibrationFileError {
    /// The operating system refused.
    #[error("cannot {action} `{}`: {source}", path.display())]
    Io {
        /// What was tried, e.g. "open".
        action: &'static str,
        /// The file.
        path: PathBuf,
        /// The operating system's reason.
        source: io::Error,
    },
    /// Something else than a calibration of isolux.
    #[error(
        "`{}`: found {found}, expected a calibration of isolux, as `isolux calibrate` writes it", path.display()
    )]
    Foreign {
        /// The file.
        path: PathBuf,
        /// What it is.
        found: String,
    },
    /// A calibration from a newer program.
    #[error(
        "`{}`: found format version {found}, expected at most {newest}: a newer isolux wrote it; update isolux, \
         or calibrate again with this one", path.display()
    )]
    Newer {
        /// The file.
        path: PathBuf,
        /// Its version.
        found: u64,
        /// Newest version that this program reads.
        newest: u32,
    },
    /// Unknown or missing fields, or values of another type.
    #[error("`{}`: {source}; expected the fields of format version {newest} and no others", path.display())]
    Fields {
        /// The file.
        path: PathBuf,
        /// Field, line and column.
        source: serde_json::Error,
        /// Version that was expected.
        newest: u32,
    },
    /// Values that no fit can have written.
    #[error("`{}`: {source}", path.display())]
    Value {
        /// The file.
        path: PathBuf,
        /// Field, found and expected.
        source: ParameterError,
    },
}

impl CalibrationFileError {
    fn io(action: &'static str, path: &Path) -> impl FnOnce(io::Error) -> Self {
        let path = path.to_owned();
        move |source| Self::Io { action, path, source }
    }
}

/// Reads a calibration file and checks every value in it.
///
/// # Errors
/// [`CalibrationFileError`]: missing, foreign, newer, unknown fields, impossible values.
pub fn read_calibration(path: &Path) -> Result<Calibration, CalibrationFileError> {
    let file = fs::File::open(path).map_err(CalibrationFileError::io("open", path))?;
    let mut bytes = Vec::new();
    file.take(LONGEST_BYTES + 1).read_to_end(&mut bytes).map_err(CalibrationFileError::io("read", path))?;
    parse_calibration(&bytes, path)
}

/// Reads a calibration from the bytes of its file; `path` is for messages.
///
/// # Errors
/// [`CalibrationFileError`]: foreign, newer, unknown fields, impossible values.
pub fn parse_calibration(bytes: &[u8], path: &Path) -> Result<Calibration, CalibrationFileError> {
    let foreign = |found: String| CalibrationFileError::Foreign { path: path.to_owned(), found };
    if bytes.len() as u64 > LONGEST_BYTES {
        return Err(foreign(format!("more than {LONGEST_BYTES} bytes")));
    }
    let value: Value =
        serde_json::from_slice(bytes).map_err(|error| foreign(format!("no valid JSON ({error})")))?;
    let format = value.get("format").and_then(Value::as_str);
    if format != Some(Calibration::FORMAT) {
        let found =
            format.map_or("JSON without `format`".to_owned(), |format| format!("the format `{format}`"));
        return Err(foreign(found));
    }
    let version = value.get("version").and_then(Value::as_u64);
    let newest = Calibration::VERSION;
    match version {
        Some(found) if found > u64::from(newest) => {
            return Err(CalibrationFileError::Newer { path: path.to_owned(), found, newest });
        }
        Some(1..) => {}
        _ => return Err(foreign("no usable `version`".to_owned())),
    }
    // From the bytes, not from the value: the message then has line and column.
    let calibration: Calibration = serde_json::from_slice(bytes)
        .map_err(|source| CalibrationFileError::Fields { path: path.to_owned(), source, newest })?;
    calibration.check().map_err(|source| CalibrationFileError::Value { path: path.to_owned(), source })?;
    Ok(calibration)
}

/// Writes a calibration file, whole or not at all: under a temporary name beside it, then renamed. Replaces a
/// file that is there.
///
/// # Errors
/// [`CalibrationFileError::Io`], or [`CalibrationFileError::Value`] for a calibration that could not be read back.
pub fn write_calibration(calibration: &Calibration, path: &Path) -> Result<(), CalibrationFileError> {
    calibration.check().map_err(|source| CalibrationFileError::Value { path: path.to_owned(), source })?;
    let text = calibration_text(calibration, path)?;
    write_whole(path, text.as_bytes()).map_err(CalibrationFileError::io("write", path))
}

/// The text of the file. `path` is for messages.
///
/// # Errors
/// [`CalibrationFileError::Fields`] when a value cannot be written as JSON.
pub fn calibration_text(calibration: &Calibration, path: &Path) -> Result<String, CalibrationFileError> {
    serde_json::to_string_pretty(calibration).map(|text| text + "\n").map_err(|source| {
        CalibrationFileError::Fields { path: path.to_owned(), source, newest: Calibration::VERSION }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use isolux::Reference;

    fn parse(text: &str) -> Result<Calibration, CalibrationFileError> {
        parse_calibration(text.as_bytes(), Path::new("CAMERA.json"))
    }

    fn text() -> String {
        calibration_text(&Calibration::new(None, Reference::default()), Path::new("x")).unwrap()
    }

    #[test]
    fn a_file_that_was_written_can_be_read() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("CAMERA.json");
        let calibration = Calibration::new(Some("X".into()), Reference::default());
        write_calibration(&calibration, &path).unwrap();
        assert_eq!(read_calibration(&path).unwrap(), calibration);
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn what_is_not_a_calibration_is_refused_with_a_reason() {
        let cases = [
            ("", "no valid JSON"),
            ("[1]", "JSON without `format`"),
            (r#"{"format": "other"}"#, "the format `other`"),
            (r#"{"format": "isolux-calibration"}"#, "no usable `version`"),
            (r#"{"format": "isolux-calibration", "version": 0}"#, "no usable `version`"),
            (
                r#"{"format": "isolux-calibration", "version": 2}"#,
                "found format version 2, expected at most 1",
            ),
            (r#"{"format": "isolux-calibration", "version": 1}"#, "missing field"),
        ];
        for (text, expected) in cases {
            let message = parse(text).unwrap_err().to_string();
            assert!(message.contains(expected) && message.contains("CAMERA.json"), "{text}: {message}");
        }
        let unknown = text().replacen("\"warnings\"", "\"gamma\": 2.2, \"warnings\"", 1);
        assert!(parse(&unknown).unwrap_err().to_string().contains("unknown field `gamma`"));
        let impossible = text().replacen("0.75", "-0.75", 1);
        assert!(parse(&impossible).unwrap_err().to_string().contains("reference.distance_m: -0.75"));
    }

    #[test]
    fn missing_files_and_folders_are_named() {
        let folder = tempfile::tempdir().unwrap();
        for path in [folder.path().join("none.json"), folder.path().to_owned()] {
            let message = read_calibration(&path).unwrap_err().to_string();
            assert!(message.contains(&path.display().to_string()), "{message}");
        }
        let calibration = Calibration::new(None, Reference::default());
        assert!(write_calibration(&calibration, &folder.path().join("no/such/CAMERA.json")).is_err());
    }
}
