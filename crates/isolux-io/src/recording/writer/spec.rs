//! The description of a channel that is to be written.

use std::path::Path;

use isolux::Shape;

use crate::error::{RecordingError, dims_text};
use crate::recording::element::ElementType;
use crate::recording::metadata::ChannelInfo;

/// A channel that is to be written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ChannelSpec {
    /// Its name; the file is `NAME.npy`.
    pub name: String,
    /// Type of its values.
    pub element: ElementType,
    /// Dimensions of one frame, all positive: `[]` one number, `[H, W]` an image.
    pub frame_dims: Vec<usize>,
}

impl ChannelSpec {
    /// A channel with one number for each frame.
    #[must_use]
    pub fn number(name: &str, element: ElementType) -> Self {
        Self { name: name.to_owned(), element, frame_dims: Vec::new() }
    }

    /// A channel with one image for each frame.
    #[must_use]
    pub fn image(name: &str, element: ElementType, shape: Shape) -> Self {
        Self { name: name.to_owned(), element, frame_dims: vec![shape.height, shape.width] }
    }

    /// A channel that takes what [`Recording::read_raw`](crate::Recording::read_raw) reads from `channel`.
    #[must_use]
    pub fn copy_of(channel: &ChannelInfo) -> Self {
        Self { name: channel.name.clone(), element: channel.element, frame_dims: channel.frame_dims.clone() }
    }

    /// Bytes of one frame; `None` beyond what can be counted.
    pub(super) fn frame_bytes(&self) -> Option<usize> {
        self.frame_dims.iter().try_fold(self.element.size_bytes(), |bytes, &dim| bytes.checked_mul(dim))
    }

    /// Refuses a name that makes no file and frames that make no array. `path` is that of the recording.
    pub(super) fn check(&self, path: &Path) -> Result<(), RecordingError> {
        let name = &self.name;
        let plain = name.chars().all(|c| c.is_ascii_alphanumeric() || matches!(c, '_' | '-' | '.' | ' '));
        if name.is_empty() || name.starts_with('.') || !plain {
            let expected = "letters, digits, `_`, `-`, `.` or spaces, not beginning with `.`";
            return Err(RecordingError::write(path, format!("a channel named `{name}`"), expected));
        }
        if self.frame_dims.contains(&0) || self.frame_dims.len() > 16 || self.frame_bytes().is_none() {
            let found = format!("frames of {}", dims_text(&self.frame_dims));
            return Err(RecordingError::write(&path.join(name), found, "at most 16 positive dimensions"));
        }
        Ok(())
    }
}
