//! The channels of the frame that is loaded.

use isolux::{Channels, Plane};

use crate::error::{RecordingError, dims_text};
use crate::recording::channels::Places;
use crate::recording::metadata::Metadata;
use crate::recording::source::{ChannelSource, RawFrame, StoredChannel};

/// A frame whose channels are at hand.
pub(super) struct Loaded<'a> {
    pub(super) source: &'a dyn ChannelSource,
    pub(super) metadata: &'a Metadata,
    pub(super) channels: &'a [StoredChannel],
    pub(super) places: &'a Places,
    pub(super) index: usize,
}

impl<'a> Loaded<'a> {
    /// The stored channel with this flag; `None` where there is none.
    pub(super) fn raw(&self, flag: Channels) -> Result<Option<RawFrame<'a>>, RecordingError> {
        self.places.get(flag).map(|place| self.raw_at(place)).transpose()
    }

    /// The channel at this place, which must be one that was loaded. What the source lends is held against what it
    /// promised, once for all that relies on it.
    pub(super) fn raw_at(&self, place: usize) -> Result<RawFrame<'a>, RecordingError> {
        let (frame, channel) = (self.source.raw(place), &self.channels[place]);
        let bytes = channel.frame_dims.iter().product::<usize>() * channel.element.size_bytes();
        if frame.element == channel.element && frame.dims == channel.frame_dims && frame.bytes.len() == bytes
        {
            return Ok(frame);
        }
        let text = |dims: &[usize], element, bytes: usize| {
            format!("{} of {element} in {bytes} bytes", dims_text(dims))
        };
        let found = text(frame.dims, frame.element, frame.bytes.len());
        let expected = text(&channel.frame_dims, channel.element, bytes);
        let found = format!("frame {} of another kind: {found}", self.index);
        Err(RecordingError::content(&channel.path, found, expected))
    }

    /// Reads a channel as it is; false where there is none.
    pub(super) fn plane(&self, flag: Channels, plane: &mut Plane<f32>) -> Result<bool, RecordingError> {
        let Some(frame) = self.raw(flag)? else { return Ok(false) };
        plane.reshape(self.metadata.shape, f32::NAN);
        frame.read_f32(plane.values_mut());
        Ok(true)
    }

    /// Reads a channel as it is where it is wanted, and empties the slot where it is not.
    pub(super) fn optional_plane(
        &self,
        flag: Channels,
        wanted: Channels,
        plane: &mut Option<Plane<f32>>,
    ) -> Result<(), RecordingError> {
        if wanted.contains(flag) {
            let shape = self.metadata.shape;
            self.plane(flag, plane.get_or_insert_with(|| Plane::filled(shape, f32::NAN)))?;
        } else {
            *plane = None;
        }
        Ok(())
    }

    /// The values of a small channel.
    pub(super) fn numbers<const COUNT: usize>(
        &self,
        flag: Channels,
    ) -> Result<Option<[f64; COUNT]>, RecordingError> {
        let Some(frame) = self.raw(flag)? else { return Ok(None) };
        let mut numbers = [f64::NAN; COUNT];
        frame.read_f64(&mut numbers);
        Ok(Some(numbers))
    }
}
