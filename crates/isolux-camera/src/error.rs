//! What can be wrong with a camera, a scene or a request for a frame.

/// Why a camera, a scene or a frame was refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CameraError {
    /// A file is not valid TOML, or its fields are not those of the format.
    #[error("{document}, line {line}: {message}")]
    Document {
        /// Name of the file, as the caller gave it.
        document: String,
        /// Line, counted from 1.
        line: usize,
        /// What was found and what was expected.
        message: String,
    },
    /// A field holds a value that makes no sense.
    #[error(transparent)]
    Value(#[from] InvalidValue),
    /// A file was written for a newer version of the format.
    #[error("{document}: `version` is {found}, this program reads version {supported}; use a newer isolux")]
    Version {
        /// Name of the file.
        document: String,
        /// Version that the file names.
        found: i64,
        /// The only version that is read.
        supported: i64,
    },
    /// No camera or scene of this name is built in.
    #[error("there is no built-in {kind} `{found}`; there are: {known}")]
    UnknownName {
        /// `camera` or `scene`.
        kind: &'static str,
        /// The name that was asked for.
        found: String,
        /// All names, separated by commas.
        known: String,
    },
    /// The recording has fewer frames.
    #[error("frame {index} was asked for, but the recording has {length} frames (0 to {})", length - 1)]
    FrameIndex {
        /// Index that was asked for.
        index: usize,
        /// Number of frames, at least one.
        length: usize,
    },
    /// Nothing is left to record.
    #[error(
        "scene `{scene}` leaves no frame to record: every pose is over-saturated at every integration time; \
         move the object away, or shorten `integration_times_us`"
    )]
    NoFrames {
        /// Name of the scene.
        scene: String,
    },
    /// The scene asks for more frames than a recording may have.
    #[error("scene `{scene}` asks for {found} frames, at most {limit} are supported; record fewer")]
    TooManyFrames {
        /// Name of the scene.
        scene: String,
        /// Frames that the scene asks for.
        found: usize,
        /// Largest number of frames.
        limit: usize,
    },
}

/// A field whose value makes no sense.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}`{field}` is {found}; expected: {expected}", location(.document, *.line))]
pub struct InvalidValue {
    /// Name of the file, empty when the value was not read from one.
    pub document: String,
    /// Line in that file, counted from 1.
    pub line: Option<usize>,
    /// Path of the field, for example `object[2].texture.uniform`.
    pub field: String,
    /// The value, as text.
    pub found: String,
    /// What would be right, with its unit.
    pub expected: String,
}

fn location(document: &str, line: Option<usize>) -> String {
    match (document, line) {
        ("", _) => String::new(),
        (document, None) => format!("{document}: "),
        (document, Some(line)) => format!("{document}, line {line}: "),
    }
}

/// Refuses the value of `field` unless `right`.
pub(crate) fn ensure(
    right: bool,
    field: impl FnOnce() -> String,
    found: impl std::fmt::Debug,
    expected: &str,
) -> Result<(), InvalidValue> {
    if right {
        return Ok(());
    }
    Err(InvalidValue {
        document: String::new(),
        line: None,
        field: field(),
        found: format!("{found:?}"),
        expected: expected.to_owned(),
    })
}
