//! Why a header could not be understood.

use std::io;

/// Why a header could not be understood.
#[derive(Debug)]
pub(crate) enum HeaderError {
    Io(io::Error),
    Content { found: String, expected: String },
}

/// An error in the contents.
pub(super) fn unlike(found: impl Into<String>, expected: &str) -> HeaderError {
    HeaderError::Content { found: found.into(), expected: expected.to_owned() }
}
