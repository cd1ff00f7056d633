//! What is known of a recording before its first frame is read.

use std::path::PathBuf;

use isolux::{Channels, Shape};

use super::element::{ByteOrder, ElementType};
use super::info::RecordingInfo;
use crate::error::{RecordingError, listing};

/// What a recording holds.
#[derive(Clone, Debug, PartialEq)]
pub struct Metadata {
    /// The path it was opened by.
    pub path: PathBuf,
    /// Number of frames, at least 1.
    pub frame_count: usize,
    /// Height and width of every frame.
    pub shape: Shape,
    /// The channels, stored ones by name, then those that reading computes.
    pub channels: Vec<ChannelInfo>,
    /// The channels that [`read_frame`](super::Recording::read_frame) can fill.
    pub available: Channels,
    /// `recording.json`; all fields empty where there is none.
    pub info: RecordingInfo,
}

/// One channel of a recording.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ChannelInfo {
    /// Its name: that of its file, without `.npy`.
    pub name: String,
    /// Type of its values, as stored.
    pub element: ElementType,
    /// Dimensions of one frame: `[]` one number, `[H, W]` an image, `[4, H, W]` bins, `[4, 4]` a pose.
    pub frame_dims: Vec<usize>,
    /// How it is stored.
    pub storage: Storage,
}

/// How a channel is stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Storage {
    /// An array in a file or archive.
    File {
        /// Byte order of its values.
        byte_order: ByteOrder,
        /// True where the first index varies fastest; such files are read in batches of frames.
        fortran_order: bool,
        /// True for a compressed member of an archive; such members are read from front to back.
        deflated: bool,
    },
    /// One value for all frames, in `recording.json`.
    Constant,
    /// Computed from the phase samples when a frame is read.
    FromPhaseSamples,
}

impl ChannelInfo {
    /// Bytes of one frame.
    #[must_use]
    pub fn frame_bytes(&self) -> usize {
        self.frame_dims.iter().product::<usize>() * self.element.size_bytes()
    }

    /// True for a channel that is in a file, not computed or constant: it can be read verbatim.
    #[must_use]
    pub fn is_stored(&self) -> bool {
        matches!(self.storage, Storage::File { .. })
    }
}

impl Metadata {
    /// The stored channel of this name.
    #[must_use]
    pub fn channel(&self, name: &str) -> Option<&ChannelInfo> {
        self.channels.iter().find(|channel| channel.is_stored() && channel.name == name)
    }

    /// The stored channel of this name, or an error that lists those that are there.
    ///
    /// # Errors
    /// [`RecordingError::NoChannel`].
    pub fn require_channel(&self, name: &str) -> Result<&ChannelInfo, RecordingError> {
        self.channel(name).ok_or_else(|| RecordingError::NoChannel {
            path: self.path.clone(),
            channel: name.to_owned(),
            found: listing(self.channels.iter().filter(|c| c.is_stored()).map(|c| c.name.as_str())),
        })
    }

    /// Refuses an index beyond the last frame.
    ///
    /// # Errors
    /// [`RecordingError::NoFrame`].
    pub fn check_frame(&self, index: usize) -> Result<(), RecordingError> {
        if index < self.frame_count {
            return Ok(());
        }
        Err(RecordingError::NoFrame { path: self.path.clone(), index, frame_count: self.frame_count })
    }
}

/// A shape as NumPy prints it: `(3, 4)`, `(3,)`, `()`.
pub(crate) fn dims_text(dims: &[usize]) -> String {
    match dims {
        [one] => format!("({one},)"),
        _ => format!("({})", dims.iter().map(usize::to_string).collect::<Vec<_>>().join(", ")),
    }
}
