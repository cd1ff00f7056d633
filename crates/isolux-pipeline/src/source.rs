//! Where frames come from: a recording, the simulated camera, or memory.

use std::path::PathBuf;

use isolux::{Channels, Frame, Intrinsics, RecordingTraits, Shape};
use isolux_io::recording::{ChannelInfo, Storage};
use isolux_io::{Recording, RecordingInfo};

use crate::error::PipelineError;

/// What is known about the frames before the first is read.
#[derive(Clone, Debug, PartialEq)]
pub struct SourceFacts {
    /// Name in messages and in the provenance of results: the path of a recording.
    pub name: String,
    /// Height and width of every frame.
    pub shape: Shape,
    /// The channels that frames can have.
    pub available: Channels,
    /// Number of frames, where it is known beforehand.
    pub frame_count: Option<usize>,
    /// True where the amplitude was not delivered, but computed from the phase samples.
    pub amplitude_from_phase_samples: bool,
    /// Everything else that is known of the camera and its settings.
    pub info: RecordingInfo,
}

impl SourceFacts {
    /// Facts about frames of which only these are known.
    #[must_use]
    pub fn new(name: impl Into<String>, shape: Shape, available: Channels) -> Self {
        Self {
            name: name.into(),
            shape,
            available,
            frame_count: None,
            amplitude_from_phase_samples: false,
            info: RecordingInfo::default(),
        }
    }

    /// Pinhole intrinsics of the camera.
    #[must_use]
    pub fn intrinsics(&self) -> Option<Intrinsics> {
        self.info.intrinsics.as_ref().map(|intrinsics| intrinsics.pinhole)
    }

    /// What a plan must know about the frames.
    #[must_use]
    pub fn traits(&self) -> RecordingTraits {
        RecordingTraits {
            channels: self.available,
            shape: Some(self.shape),
            intrinsics: self.intrinsics(),
            modulation_frequency_hz: self.info.modulation_frequency_hz,
            ambient_light: None,
            relative_exposure: None,
        }
    }
}

/// Frames of one camera in their order. Every [`Recording`] is one.
pub trait FrameSource {
    /// What is known of the frames.
    fn facts(&self) -> SourceFacts;

    /// Reads frame `index`, counted from 0, into `frame`, whose memory is reused; `false` when the frames end
    /// before it. Ascending reads are fast; whether other orders are possible depends on the source.
    ///
    /// Those of the `wanted` channels that the source has are filled; others may be.
    ///
    /// # Errors
    /// [`PipelineError`] when the frame cannot be read. `frame` is then partly filled.
    fn read(&mut self, index: usize, wanted: Channels, frame: &mut Frame) -> Result<bool, PipelineError>;

    /// The channels that [`FrameSource::read_raw`] can copy; none, unless the source is stored.
    fn stored_channels(&self) -> Vec<ChannelInfo> {
        Vec::new()
    }

    /// Reads one frame of a stored channel verbatim into `bytes`: C order, little-endian, in the channel's own element
    /// type.
    ///
    /// # Errors
    /// [`PipelineError`] when the channel is not stored or cannot be read.
    fn read_raw(&mut self, channel: &str, index: usize, bytes: &mut Vec<u8>) -> Result<(), PipelineError> {
        let _ = (index, bytes);
        let cause = format!("no stored channel `{channel}` found, one expected").into();
        Err(PipelineError::Frames { recording: self.facts().name, cause })
    }
}

impl FrameSource for dyn Recording + '_ {
    fn facts(&self) -> SourceFacts {
        let metadata = self.metadata();
        let computed = |channel: &ChannelInfo| {
            channel.name == "amplitude" && channel.storage == Storage::FromPhaseSamples
        };
        SourceFacts {
            name: metadata.path.display().to_string(),
            shape: metadata.shape,
            available: metadata.available,
            frame_count: metadata.frame_count,
            amplitude_from_phase_samples: metadata.channels.iter().any(computed),
            info: metadata.info.clone(),
        }
    }

    fn read(&mut self, index: usize, wanted: Channels, frame: &mut Frame) -> Result<bool, PipelineError> {
        Ok(self.read_frame_if_there(index, wanted, frame)?)
    }

    fn stored_channels(&self) -> Vec<ChannelInfo> {
        self.metadata().channels.iter().filter(|channel| channel.is_stored()).cloned().collect()
    }

    fn read_raw(&mut self, channel: &str, index: usize, bytes: &mut Vec<u8>) -> Result<(), PipelineError> {
        Ok(Recording::read_raw(self, channel, index, bytes)?)
    }
}

impl<S: FrameSource + ?Sized> FrameSource for Box<S> {
    fn facts(&self) -> SourceFacts {
        (**self).facts()
    }

    fn read(&mut self, index: usize, wanted: Channels, frame: &mut Frame) -> Result<bool, PipelineError> {
        (**self).read(index, wanted, frame)
    }

    fn stored_channels(&self) -> Vec<ChannelInfo> {
        (**self).stored_channels()
    }

    fn read_raw(&mut self, channel: &str, index: usize, bytes: &mut Vec<u8>) -> Result<(), PipelineError> {
        (**self).read_raw(channel, index, bytes)
    }
}

/// Frames that are in memory.
#[derive(Clone, Debug)]
pub struct FramesInMemory<'a> {
    facts: SourceFacts,
    frames: Vec<&'a Frame>,
}

impl<'a> FramesInMemory<'a> {
    /// Frames and what is known of them; their number is counted.
    pub fn new(facts: SourceFacts, frames: impl IntoIterator<Item = &'a Frame>) -> Self {
        let frames: Vec<&Frame> = frames.into_iter().collect();
        Self { facts: SourceFacts { frame_count: Some(frames.len()), ..facts }, frames }
    }
}

impl FrameSource for FramesInMemory<'_> {
    fn facts(&self) -> SourceFacts {
        self.facts.clone()
    }

    fn read(&mut self, index: usize, _: Channels, frame: &mut Frame) -> Result<bool, PipelineError> {
        let Some(found) = self.frames.get(index) else { return Ok(false) };
        frame.clone_from(found);
        Ok(true)
    }
}

/// Opens recordings as sources of frames.
pub(crate) fn open_all(paths: &[PathBuf]) -> Result<Vec<Box<dyn FrameSource>>, PipelineError> {
    let open = |path: &PathBuf| {
        let recording = isolux_io::open(path)?;
        Ok(Box::new(recording) as Box<dyn FrameSource>)
    };
    paths.iter().map(open).collect()
}
