//! Writes native recordings frame by frame.

mod output;
mod recording_writer;
mod spec;

pub use recording_writer::RecordingWriter;
pub use spec::ChannelSpec;
