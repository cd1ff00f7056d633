//! The trait that every recording is read through, whatever its format.

use isolux::{Channels, Frame, Plane};

use super::metadata::Metadata;
use crate::error::RecordingError;

/// A sequence of frames of one camera. Ascending reads are fast; [`Metadata::access`] says which other orders are
/// possible.
///
/// A new format does not implement this trait but [`ChannelSource`](super::ChannelSource).
pub trait Recording: Send {
    /// What the recording holds.
    fn metadata(&self) -> &Metadata;

    /// Reads frame `index`, counted from 0, into `frame`, whose memory is reused. `Ok(false)` says that the
    /// recording ended before this frame; `frame` is then as it was.
    ///
    /// Of the `wanted` channels, those that the recording has are filled, in the units of [`Frame`]: distance is
    /// made radial and metric; amplitude and distance are computed from the phase samples where they are not
    /// recorded, eq. 1 and section 2.1 of Stürmer, Penne and Hornegger (2008); phase samples come in the paper's
    /// order and sign. Everything else in `frame` becomes `None` or unknown; an amplitude that is not wanted
    /// becomes NaN without a flag. The flags start empty; then pixels without a measurement are marked, and those
    /// with a phase sample at the clip level (methods: 0.985 of `saturated_phase_sample`) become SATURATED.
    ///
    /// # Errors
    /// [`RecordingError::MissingAmplitude`] when amplitude is wanted and the recording has no way to it;
    /// [`RecordingError::Passed`] for a frame that cannot be reached any more; [`RecordingError::Value`] for an
    /// integration time that is negative or infinite, or, of a whole frame, 0, and for a label beyond 0 to 255;
    /// and what the files bring. `frame` is then partly filled.
    fn read_frame_if_there(
        &mut self,
        index: usize,
        wanted: Channels,
        frame: &mut Frame,
    ) -> Result<bool, RecordingError>;

    /// Reads frame `index`, which must be there, as
    /// [`read_frame_if_there`](Self::read_frame_if_there) does.
    ///
    /// # Errors
    /// [`RecordingError::NoFrame`], and those of `read_frame_if_there`.
    fn read_frame(
        &mut self,
        index: usize,
        wanted: Channels,
        frame: &mut Frame,
    ) -> Result<(), RecordingError> {
        if self.read_frame_if_there(index, wanted, frame)? {
            return Ok(());
        }
        Err(no_frame(self.metadata(), index))
    }

    /// Reads one frame of a stored channel verbatim into `bytes`: C order, little-endian, in the channel's own
    /// element type. The bytes fit [`RecordingWriter::push_bytes`](super::RecordingWriter::push_bytes).
    ///
    /// # Errors
    /// [`RecordingError::NoFrame`], [`RecordingError::NoChannel`], [`RecordingError::Passed`], and what the files
    /// bring.
    fn read_raw(&mut self, channel: &str, index: usize, bytes: &mut Vec<u8>) -> Result<(), RecordingError>;

    /// Reads one frame of any stored H×W channel as it is, without change of unit. Integers beyond 2²⁴ are
    /// rounded to `f32`.
    ///
    /// # Errors
    /// [`RecordingError::ChannelShape`] for a channel that is no image, and those of [`read_raw`](Self::read_raw).
    fn read_plane(
        &mut self,
        channel: &str,
        index: usize,
        plane: &mut Plane<f32>,
    ) -> Result<(), RecordingError>;
}

/// Reads every frame, in order, into the same memory and hands it over with its number; gives back how many there
/// were. Works for recordings of any length, known or not.
///
/// ```
/// # let folder = tempfile::tempdir()?;
/// # let path = folder.path().join("recording");
/// # let channels = vec![isolux_io::ChannelSpec::number("n", isolux_io::ElementType::U8),
/// #     isolux_io::ChannelSpec::image("amplitude", isolux_io::ElementType::U8, isolux::Shape::new(1, 1))];
/// # let mut writer = isolux_io::RecordingWriter::create(&path, 1, channels, false)?;
/// # writer.push("n", &[1u8])?;
/// # writer.push("amplitude", &[7u8])?;
/// # writer.finish(&isolux_io::RecordingInfo::default())?;
/// use isolux::Channels;
/// use isolux_io::RecordingError;
///
/// let mut recording = isolux_io::open(&path)?;
/// let mut brightest = 0.0;
/// let frames = isolux_io::for_each_frame(&mut *recording, Channels::AMPLITUDE, |_, frame| {
///     brightest = frame.amplitude.values().iter().fold(brightest, |a: f32, &b| a.max(b));
///     Ok::<(), RecordingError>(())
/// })?;
/// assert_eq!((frames, brightest), (1, 7.0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// Those of [`Recording::read_frame_if_there`], and the first one that `visit` returns.
pub fn for_each_frame<E: From<RecordingError>>(
    recording: &mut dyn Recording,
    wanted: Channels,
    mut visit: impl FnMut(usize, &Frame) -> Result<(), E>,
) -> Result<usize, E> {
    let mut frame = Frame::new(recording.metadata().shape);
    let mut index = 0;
    while recording.read_frame_if_there(index, wanted, &mut frame)? {
        visit(index, &frame)?;
        index += 1;
    }
    Ok(index)
}

/// The error for a frame beyond the last one.
pub(crate) fn no_frame(metadata: &Metadata, index: usize) -> RecordingError {
    // The number of frames is known once the end has been found.
    let frame_count = metadata.frame_count.unwrap_or(index);
    RecordingError::NoFrame { path: metadata.path.clone(), index, frame_count }
}
