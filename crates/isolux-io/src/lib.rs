//! Reads and writes recordings of time-of-flight cameras.
//!
//! A recording is a sequence of frames of one camera. [`open`] looks at what a path holds and gives back a
//! [`Recording`], whatever the format; [`RecordingWriter`] writes the native format. Both go frame by frame: a
//! recording never has to fit in memory.

pub mod calibration_file;
pub mod error;
pub mod recording;
mod whole_file;

pub use calibration_file::{CalibrationFileError, read_calibration, write_calibration};
pub use error::RecordingError;
pub use recording::{
    Assembled, ChannelSource, ChannelSpec, ElementType, Metadata, Recording, RecordingInfo, RecordingWriter,
    for_each_frame, open,
};
pub use whole_file::write_whole;

/// The library example of the README, compiled as a test.
#[cfg(doctest)]
#[doc = include_str!("../../../README.md")]
struct Readme;
