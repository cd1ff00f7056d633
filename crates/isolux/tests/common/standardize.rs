//! The one place where the tests call a [`Standardizer`].

use isolux::standardize::{StandardizeError, Stream};
use isolux::{Frame, Standardized, Standardizer};

/// One frame, in memory of its own.
pub fn standardize(standardizer: &Standardizer, frame: &Frame) -> Standardized {
    try_standardize(standardizer, frame).unwrap()
}

/// The same, where it may be refused.
pub fn try_standardize(standardizer: &Standardizer, frame: &Frame) -> Result<Standardized, StandardizeError> {
    next(&mut standardizer.stream(), frame)
}

/// The next frame of a stream.
pub fn next(stream: &mut Stream, frame: &Frame) -> Result<Standardized, StandardizeError> {
    stream.push(frame).cloned()
}
