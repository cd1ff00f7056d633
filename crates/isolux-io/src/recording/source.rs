//! What a format has to deliver: its channels as they are stored, frame by frame.

use std::path::PathBuf;
use std::sync::Arc;

use isolux::RayTable;

use super::element::{self, ByteOrder, ElementType, Number};
use super::info::RecordingInfo;
use super::metadata::Access;
use crate::error::RecordingError;

/// A recording as one format stores it.
///
/// Implement this for a new format, and [`Assembled`](super::Assembled) makes a [`Recording`](super::Recording) of
/// it: units, radial distances, amplitude from the phase samples, flags, and the checks of shapes and values are
/// done there, for all formats alike. The crate's page has a complete example.
///
/// A frame is taken in two steps, so that the bytes of several channels can be looked at together:
/// [`load`](Self::load) brings a frame into the source's memory, [`raw`](Self::raw) lends its channels.
pub trait ChannelSource: Send {
    /// What the source holds. Asked once, before anything else.
    fn describe(&self) -> SourceDescription;

    /// A table of the direction that each pixel looks in, where the source has one. Asked once, after
    /// [`describe`](Self::describe).
    fn rays(&self) -> Option<Arc<RayTable>> {
        None
    }

    /// Makes `index`, counted from 0, the current frame, with `channels` ready for [`raw`](Self::raw): places in
    /// the list of [`SourceDescription::channels`]. `Ok(false)` says that the recording ended before this frame.
    ///
    /// A source with [`Access::Random`] and a known number of frames is asked for any of them. Every other source
    /// is asked for frame 0 first, and then for the current frame again (with the same or other channels) or the
    /// next one; a frame that is passed over is asked for with no channels. After an error or the end, only
    /// [`rewind`](Self::rewind) follows.
    ///
    /// # Errors
    /// Those of reading the files. The source checks what it needs to read on; whether the channels have the
    /// dimensions and types of its description is checked for it.
    fn load(&mut self, index: usize, channels: &[usize]) -> Result<bool, RecordingError>;

    /// The current frame of a channel that was loaded with it. Of any other channel, the contents do not matter.
    fn raw(&self, channel: usize) -> RawFrame<'_>;

    /// Starts anew: the next frame to be loaded is the first. Asked only of a source with [`Access::Rewindable`],
    /// or one with [`Access::Random`] that does not know its number of frames.
    ///
    /// # Errors
    /// Those of reading the files.
    fn rewind(&mut self) -> Result<(), RecordingError> {
        Ok(())
    }
}

/// The description of a source.
#[derive(Clone, Debug)]
pub struct SourceDescription {
    /// The path that the recording was opened by.
    pub path: PathBuf,
    /// Number of frames, at least 1; `None` where it is only known after reading to the end.
    pub frame_count: Option<usize>,
    /// In which order frames can be read.
    pub access: Access,
    /// The channels. Names with a meaning are those of the native format: `amplitude`, `distance`,
    /// `integration_time_us`, `phase_samples`, `intensity`, `timestamp_us`, `target`, `vendor_amplitude`,
    /// `vendor_confidence`, `world_from_camera`, `standardized_amplitude`, `sigma`, `flags`. A channel of any other
    /// name is carried along.
    pub channels: Vec<StoredChannel>,
    /// What is known besides the channels: units, intrinsics, codes.
    pub info: RecordingInfo,
    /// Where `info` comes from, for messages.
    pub info_path: PathBuf,
}

/// One channel of a source.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StoredChannel {
    /// Its name.
    pub name: String,
    /// The file that it is in, or another way to say where it comes from; for messages.
    pub path: PathBuf,
    /// Type of its values.
    pub element: ElementType,
    /// Dimensions of one frame: `[]` one number, `[H, W]` an image, `[4, H, W]` bins, `[4, 4]` a pose.
    pub frame_dims: Vec<usize>,
    /// What a reader may want to know of how it is stored, such as "deflated"; empty where nothing is remarkable.
    pub note: String,
}

/// One frame of one channel as its source holds it: borrowed, not converted.
#[derive(Clone, Copy, Debug)]
pub struct RawFrame<'a> {
    /// Type of the values; that of the channel.
    pub element: ElementType,
    /// Byte order of the values.
    pub byte_order: ByteOrder,
    /// Dimensions of the frame; those of the channel.
    pub dims: &'a [usize],
    /// The values one behind the other, last index fastest.
    pub bytes: &'a [u8],
}

impl<'a> RawFrame<'a> {
    /// A frame of values that a decoder left in memory: the same bytes, borrowed.
    #[must_use]
    pub fn of<T: Number>(dims: &'a [usize], values: &'a [T]) -> Self {
        Self { element: T::TYPE, byte_order: ByteOrder::NATIVE, dims, bytes: T::as_bytes(values) }
    }

    /// Converts the values to `f32`; integers beyond 2²⁴ are rounded. Fills as many of `out` as there are values.
    pub fn read_f32(&self, out: &mut [f32]) {
        element::decode_f32(self.element, self.byte_order, self.bytes, out);
    }

    /// Converts the values to `f64`. Fills as many of `out` as there are values.
    pub fn read_f64(&self, out: &mut [f64]) {
        element::decode_f64(self.element, self.byte_order, self.bytes, out);
    }

    /// Appends the values as little-endian bytes.
    pub fn append_little_endian(&self, bytes: &mut Vec<u8>) {
        element::append_as_little_endian(self.element, self.byte_order, self.bytes, bytes);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_in_memory_are_lent_as_they_are() {
        let values = [1u16, 515];
        let frame = RawFrame::of(&[1, 2], &values);
        assert_eq!(frame.bytes.as_ptr(), values.as_ptr().cast());
        let (mut numbers, mut bytes) = ([0.0; 2], vec![9]);
        frame.read_f32(&mut numbers);
        frame.append_little_endian(&mut bytes);
        assert_eq!((numbers, bytes), ([1.0, 515.0], vec![9, 1, 0, 3, 2]));
    }
}
