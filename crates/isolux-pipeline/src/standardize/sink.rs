//! Where standardized frames go.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use isolux::{RayTable, Shape, Standardized};
use isolux_io::recording::ChannelInfo;
use isolux_io::{ChannelSpec, ElementType, RecordingInfo, RecordingWriter};

use crate::error::PipelineError;

/// Name of the channel of standardized amplitudes.
pub const VALUES: &str = "standardized_amplitude";
/// Name of the channel of their flags.
pub const FLAGS: &str = "flags";
/// Name of the channel of their predicted standard deviation.
pub const SIGMA: &str = "sigma";

/// What a sink must know before the first frame.
#[derive(Clone, Debug, PartialEq)]
pub struct OutputFormat {
    /// The source, for messages.
    pub source: String,
    /// Height and width of every frame.
    pub shape: Shape,
    /// Number of frames, where it is known beforehand.
    pub frame_count: Option<usize>,
    /// True where frames have a predicted standard deviation.
    pub sigma: bool,
    /// Channels of the source that are copied verbatim.
    pub kept: Vec<ChannelInfo>,
    /// The direction of each pixel, where a table of them is all that is known of the lens.
    pub rays: Option<Arc<RayTable>>,
}

/// One frame of the result.
#[derive(Clone, Copy, Debug)]
pub struct OutputFrame<'a> {
    /// Values, flags and, where it is predicted, the standard deviation.
    pub standardized: &'a Standardized,
    /// The frame of each kept channel: C order, little-endian, in the channel's own element type.
    pub kept: &'a [Vec<u8>],
}

/// Where standardized frames go: a recording of some format, an array, a screen. Frames come in their order. A sink that
/// is dropped before it is finished leaves nothing behind.
pub trait FrameSink {
    /// Called once, before the first frame.
    ///
    /// # Errors
    /// [`PipelineError`] when the sink cannot take such frames.
    fn begin(&mut self, format: &OutputFormat) -> Result<(), PipelineError>;

    /// Takes the next frame.
    ///
    /// # Errors
    /// [`PipelineError`] when it cannot be taken.
    fn push(&mut self, frame: OutputFrame<'_>) -> Result<(), PipelineError>;

    /// Called once, after the last frame. `info` is that of the source, with the record of the steps.
    ///
    /// # Errors
    /// [`PipelineError`] when the result cannot be completed.
    fn finish(&mut self, info: &RecordingInfo) -> Result<(), PipelineError>;
}

/// Writes a recording of the native format: a folder, or an archive where the name ends in `.npz`.
pub struct NativeSink {
    path: PathBuf,
    overwrite: bool,
    open: Option<(RecordingWriter, Vec<String>)>,
}

impl NativeSink {
    /// The recording will be at `path` once it is finished. What is there is replaced only if it is a recording and
    /// `overwrite` is true.
    #[must_use]
    pub fn new(path: &Path, overwrite: bool) -> Self {
        Self { path: path.to_owned(), overwrite, open: None }
    }
}

impl FrameSink for NativeSink {
    fn begin(&mut self, format: &OutputFormat) -> Result<(), PipelineError> {
        let mut channels = vec![
            ChannelSpec::image(VALUES, ElementType::F32, format.shape),
            ChannelSpec::image(FLAGS, ElementType::U16, format.shape),
        ];
        if format.sigma {
            channels.push(ChannelSpec::image(SIGMA, ElementType::F32, format.shape));
        }
        channels.extend(format.kept.iter().map(ChannelSpec::copy_of));
        let kept = format.kept.iter().map(|channel| channel.name.clone()).collect();
        let mut writer = RecordingWriter::create(&self.path, format.frame_count, channels, self.overwrite)?;
        if let Some(rays) = &format.rays {
            writer.write_rays(rays)?;
        }
        self.open = Some((writer, kept));
        Ok(())
    }

    fn push(&mut self, frame: OutputFrame<'_>) -> Result<(), PipelineError> {
        let Some((writer, kept)) = &mut self.open else { return Ok(()) };
        writer.push(VALUES, frame.standardized.amplitude.values())?;
        writer.push(FLAGS, frame.standardized.flags.values())?;
        if let Some(sigma) = &frame.standardized.sigma {
            writer.push(SIGMA, sigma.values())?;
        }
        for (name, bytes) in kept.iter().zip(frame.kept) {
            writer.push_bytes(name, bytes)?;
        }
        Ok(())
    }

    fn finish(&mut self, info: &RecordingInfo) -> Result<(), PipelineError> {
        match self.open.take() {
            Some((writer, _)) => Ok(writer.finish(info)?),
            None => Ok(()),
        }
    }
}
