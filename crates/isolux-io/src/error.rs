//! What can go wrong with a recording.

use std::io;
use std::path::{Path, PathBuf};

/// Why a recording could not be read or written. Every message names the file, what was found there and what was
/// expected; a member of an archive is named as `ARCHIVE/MEMBER`.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RecordingError {
    /// The operating system refused.
    #[error("cannot {action} `{}`: {source}", path.display())]
    Io {
        /// What was tried, e.g. "open".
        action: &'static str,
        /// File or folder.
        path: PathBuf,
        /// The operating system's reason.
        source: io::Error,
    },
    /// The path is not a recording.
    #[error(
        "`{}`: found {found}; expected a recording: a folder of .npy files, a folder with recording.npz, \
         or a .npz file", path.display()
    )]
    NotARecording {
        /// The path that was given.
        path: PathBuf,
        /// What is there.
        found: String,
    },
    /// A file is damaged, or of a kind that is not supported.
    #[error("`{}`: found {found}, expected {expected}", file.display())]
    Content {
        /// The file.
        file: PathBuf,
        /// What it holds.
        found: String,
        /// What it should hold.
        expected: String,
    },
    /// An array has another shape than its channel demands.
    #[error("`{}`: found an array of shape {found}, expected {expected}{advice}", file.display())]
    ChannelShape {
        /// The channel's file.
        file: PathBuf,
        /// Its shape.
        found: String,
        /// The shapes that would fit.
        expected: String,
        /// What to do, or nothing.
        advice: String,
    },
    /// The recording has neither amplitude nor phase samples.
    #[error("`{}`: found no `amplitude` and no `phase_samples`, only {found}; one of the two is needed", path.display())]
    MissingAmplitude {
        /// The recording.
        path: PathBuf,
        /// The channels that are there.
        found: String,
    },
    /// `recording.json` is not JSON.
    #[error("`{}`: not valid JSON: {source}", path.display())]
    Json {
        /// The file.
        path: PathBuf,
        /// Where and why.
        source: serde_json::Error,
    },
    /// A field of `recording.json` cannot be used.
    #[error("`{}`, field `{field}`: found {found}, expected {expected}", path.display())]
    Info {
        /// The JSON file.
        path: PathBuf,
        /// The field.
        field: String,
        /// Its value.
        found: String,
        /// What it should be.
        expected: String,
    },
    /// A value of a channel has no meaning.
    #[error("`{}`, frame {frame}{}: found {found}, expected {expected}", file.display(), at(pixel.as_ref()))]
    Value {
        /// The channel's file.
        file: PathBuf,
        /// Index of the frame, from 0.
        frame: usize,
        /// Row and column, where it is one pixel's value.
        pixel: Option<(usize, usize)>,
        /// The value.
        found: f64,
        /// What it should be.
        expected: &'static str,
    },
    /// A frame was asked for that is not there.
    #[error("`{}` has no frame {index}: it holds {frame_count}, counted from 0", path.display())]
    NoFrame {
        /// The recording.
        path: PathBuf,
        /// Index that was asked for.
        index: usize,
        /// Number of frames.
        frame_count: usize,
    },
    /// A frame was asked for that has been passed and cannot be read again.
    #[error(
        "`{}`: frame {index} was asked for after it had been passed; expected an order from front to back: this \
         recording can be read only once", path.display()
    )]
    Passed {
        /// The recording.
        path: PathBuf,
        /// Index that was asked for.
        index: usize,
    },
    /// The number of frames is needed before the first one is read.
    #[error(
        "`{}`: found a recording whose number of frames is known only at its end, expected one that states it", path.display()
    )]
    UnknownLength {
        /// The recording.
        path: PathBuf,
    },
    /// A channel was asked for that is not there.
    #[error("`{}` has no channel `{channel}`; it holds {found}", path.display())]
    NoChannel {
        /// The recording.
        path: PathBuf,
        /// Name that was asked for.
        channel: String,
        /// The channels that are there.
        found: String,
    },
    /// The output is there already.
    #[error("`{}` exists already; remove it, choose another name, or ask for it to be overwritten", path.display())]
    Exists {
        /// The output.
        path: PathBuf,
    },
    /// The output would replace something that is no recording.
    #[error("`{}` will not be overwritten: it holds {found}, which is no part of a recording", path.display())]
    NotReplaced {
        /// The output.
        path: PathBuf,
        /// What it holds.
        found: String,
    },
    /// The channels or frames given to the writer do not make a recording.
    #[error("`{}`: {found} to be written, {expected} expected", path.display())]
    Write {
        /// The output, with the channel where it concerns one.
        path: PathBuf,
        /// What was to be written.
        found: String,
        /// What would be right.
        expected: String,
    },
}

impl RecordingError {
    pub(crate) fn io(action: &'static str, path: &Path) -> impl FnOnce(io::Error) -> Self {
        move |source| Self::Io { action, path: path.to_owned(), source }
    }

    /// A field of `recording.json` that cannot be used, with its value, cut where it is long.
    pub(crate) fn info(path: &Path, field: &str, found: &serde_json::Value, expected: &str) -> Self {
        let mut found = found.to_string();
        if found.chars().count() > 80 {
            found = found.chars().take(77).collect::<String>() + "...";
        }
        Self::Info { path: path.to_owned(), field: field.to_owned(), found, expected: expected.to_owned() }
    }

    pub(crate) fn content(file: &Path, found: impl Into<String>, expected: impl Into<String>) -> Self {
        Self::Content { file: file.to_owned(), found: found.into(), expected: expected.into() }
    }

    pub(crate) fn write(path: &Path, found: impl Into<String>, expected: impl Into<String>) -> Self {
        Self::Write { path: path.to_owned(), found: found.into(), expected: expected.into() }
    }
}

fn at(pixel: Option<&(usize, usize)>) -> String {
    pixel.map_or(String::new(), |(row, column)| format!(", row {row}, column {column}"))
}

/// Names for a message: `a`, `b` and `c`; or "nothing".
pub(crate) fn listing<'a>(names: impl IntoIterator<Item = &'a str>) -> String {
    let names: Vec<_> = names.into_iter().map(|name| format!("`{name}`")).collect();
    match names.as_slice() {
        [] => "nothing".to_owned(),
        [one] => one.clone(),
        [first @ .., last] => format!("{} and {last}", first.join(", ")),
    }
}

/// Dimensions for a message: `(3, 4)`, `(3,)`, `()`.
pub(crate) fn dims_text(dims: &[usize]) -> String {
    match dims {
        [one] => format!("({one},)"),
        _ => format!("({})", dims.iter().map(usize::to_string).collect::<Vec<_>>().join(", ")),
    }
}
