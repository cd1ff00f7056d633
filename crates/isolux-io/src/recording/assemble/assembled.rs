//! A recording over the channels of any source.

use isolux::{Channels, Frame, Plane};

use super::check::{self, Layout};
use super::cursor::{Cursor, Reached};
use super::fill::{self, Scratch};
use super::loaded::Loaded;
use crate::error::{RecordingError, dims_text, listing};
use crate::recording::channels::Places;
use crate::recording::metadata::Metadata;
use crate::recording::reading::{Recording, no_frame};
use crate::recording::source::{ChannelSource, RawFrame, StoredChannel};

/// Makes a [`Recording`] of a [`ChannelSource`]: the part that is the same for all formats.
#[derive(Debug)]
pub struct Assembled<S> {
    cursor: Cursor<S>,
    metadata: Metadata,
    channels: Vec<StoredChannel>,
    places: Places,
    scratch: Scratch,
    /// Places of the channels to be loaded: memory that lives from frame to frame.
    wanted_places: Vec<usize>,
}

impl<S: ChannelSource> Assembled<S> {
    /// Asks the source what it holds and checks that this makes one recording. Reads no frame.
    ///
    /// # Errors
    /// [`RecordingError::MissingAmplitude`] where no channel determines the shape of the frames;
    /// [`RecordingError::Content`] for channels that do not fit it; [`RecordingError::Info`] for a description that
    /// contradicts the channels.
    pub fn new(source: S) -> Result<Self, RecordingError> {
        let description = source.describe();
        let Layout { metadata, places } = check::check(&description, source.rays())?;
        let scratch = Scratch::new(&description, &places, metadata.lens().lens);
        Ok(Self {
            cursor: Cursor::new(source, description.access, description.frame_count),
            metadata,
            channels: description.channels,
            places,
            scratch,
            wanted_places: Vec::new(),
        })
    }

    /// Loads the channels in `wanted_places` of frame `index`; false where the recording ended before it.
    fn reach(&mut self, index: usize) -> Result<bool, RecordingError> {
        match self.cursor.load(&self.metadata.path, index, &self.wanted_places)? {
            Reached::Frame => Ok(true),
            Reached::End { frame_count } => {
                self.metadata.frame_count = Some(frame_count);
                Ok(false)
            }
        }
    }

    fn loaded(&self, index: usize) -> Loaded<'_> {
        Loaded {
            source: self.cursor.source(),
            metadata: &self.metadata,
            channels: &self.channels,
            places: &self.places,
            index,
        }
    }

    /// Loads one channel of a frame that must be there.
    fn stored(&mut self, channel: &str, index: usize) -> Result<RawFrame<'_>, RecordingError> {
        self.refuse_beyond_end(index)?;
        self.metadata.require_channel(channel)?;
        self.wanted_places.clear();
        self.wanted_places.extend(self.channels.iter().position(|stored| stored.name == channel));
        if !self.reach(index)? {
            return Err(no_frame(&self.metadata, index));
        }
        let place = self.wanted_places.first().copied().unwrap_or_default();
        self.loaded(index).raw_at(place)
    }

    fn refuse_beyond_end(&self, index: usize) -> Result<(), RecordingError> {
        match self.metadata.frame_count {
            Some(count) if index >= count => Err(no_frame(&self.metadata, index)),
            _ => Ok(()),
        }
    }
}

impl<S: ChannelSource> Recording for Assembled<S> {
    fn metadata(&self) -> &Metadata {
        &self.metadata
    }

    fn read_frame_if_there(
        &mut self,
        index: usize,
        wanted: Channels,
        frame: &mut Frame,
    ) -> Result<bool, RecordingError> {
        if self.metadata.frame_count.is_some_and(|count| index >= count) {
            return Ok(false);
        }
        if wanted.contains(Channels::AMPLITUDE) && !self.metadata.available.contains(Channels::AMPLITUDE) {
            let found = listing(self.metadata.channels.iter().map(|channel| channel.name.as_str()));
            return Err(RecordingError::MissingAmplitude { path: self.metadata.path.clone(), found });
        }
        let needed = fill::needed(wanted, &self.places, &self.metadata.info);
        self.wanted_places.clear();
        self.wanted_places.extend(needed.iter().filter_map(|flag| self.places.get(flag)));
        if !self.reach(index)? {
            return Ok(false);
        }
        let loaded = Loaded {
            source: self.cursor.source(),
            metadata: &self.metadata,
            channels: &self.channels,
            places: &self.places,
            index,
        };
        fill::fill(&loaded, wanted & self.metadata.available, needed, &mut self.scratch, frame)?;
        Ok(true)
    }

    fn read_raw(&mut self, channel: &str, index: usize, bytes: &mut Vec<u8>) -> Result<(), RecordingError> {
        let frame = self.stored(channel, index)?;
        bytes.clear();
        frame.append_little_endian(bytes);
        Ok(())
    }

    fn read_plane(
        &mut self,
        channel: &str,
        index: usize,
        plane: &mut Plane<f32>,
    ) -> Result<(), RecordingError> {
        let (shape, info) = (self.metadata.shape, self.metadata.require_channel(channel)?);
        if info.frame_dims != [shape.height, shape.width] || info.element.is_complex() {
            let stored = self.channels.iter().find(|stored| stored.name == channel);
            return Err(RecordingError::ChannelShape {
                file: stored.map_or_else(|| self.metadata.path.join(channel), |stored| stored.path.clone()),
                found: dims_text(&info.frame_dims),
                expected: format!("an image of {shape}, real numbers"),
                advice: String::new(),
            });
        }
        let frame = self.stored(channel, index)?;
        plane.reshape(shape, 0.0);
        frame.read_f32(plane.values_mut());
        Ok(())
    }
}
