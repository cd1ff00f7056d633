//! Recordings: one small trait that every format implements, and the native format.
//!
//! The native form is a folder with one `.npy` file per channel and `recording.json`, or the same in one `.npz`
//! with a `.json` of the same stem beside it. A folder that holds `recording.npz` and `recording.json` is opened
//! like that archive.

mod element;
mod info;
mod layout;
mod metadata;
mod native;
mod writer;

use std::path::Path;

use isolux::{Channels, Frame, Plane, Shape};

pub use element::{ByteOrder, Element, ElementType};
pub use info::{DistanceKind, DistanceUnit, RecordedIntrinsics, RecordingInfo};
pub use metadata::{ChannelInfo, Metadata, Storage};
pub use writer::{ChannelSpec, RecordingWriter};

use crate::error::RecordingError;

/// A sequence of frames of one camera. Ascending reads are fast; any order is correct.
pub trait Recording: Send {
    /// What the recording holds.
    fn metadata(&self) -> &Metadata;

    /// Reads frame `index`, counted from 0, into `frame`, whose memory is reused.
    ///
    /// Of the `wanted` channels, those that the recording has are filled, in the units of [`Frame`]: distance is
    /// made radial and metric; amplitude and distance are computed from the phase samples where they are not
    /// recorded, eq. 1 and section 2.1 of Stürmer, Penne and Hornegger (2008); phase samples come in the paper's
    /// order and sign. Everything else in `frame` becomes `None` or unknown; an amplitude that is not wanted
    /// becomes NaN without a flag. The flags start empty; then pixels without a measurement are marked, and those
    /// with a phase sample at the clip level (methods: 0.985 of `saturated_phase_sample`) become SATURATED.
    ///
    /// # Errors
    /// [`RecordingError::NoFrame`]; [`RecordingError::MissingAmplitude`] when amplitude is wanted and the
    /// recording has no way to it; [`RecordingError::Value`] for an integration time that is negative or
    /// infinite, or, of a whole frame, 0, and for a label beyond 0 to 255; and what the files bring. `frame` is
    /// then partly filled.
    fn read_frame(&mut self, index: usize, wanted: Channels, frame: &mut Frame)
    -> Result<(), RecordingError>;

    /// Reads one frame of a stored channel verbatim into `bytes`: C order, little-endian, in the channel's own
    /// element type. The bytes fit [`RecordingWriter::push_bytes`].
    ///
    /// # Errors
    /// [`RecordingError::NoFrame`], [`RecordingError::NoChannel`], and what the files bring.
    fn read_raw(&mut self, channel: &str, index: usize, bytes: &mut Vec<u8>) -> Result<(), RecordingError>;

    /// Reads one frame of any stored H×W channel as it is, without change of unit. Integers beyond 2²⁴ are
    /// rounded to `f32`.
    ///
    /// # Errors
    /// [`RecordingError::NoFrame`], [`RecordingError::NoChannel`], [`RecordingError::ChannelShape`] for a channel
    /// that is no image, and what the files bring.
    fn read_plane(
        &mut self,
        channel: &str,
        index: usize,
        plane: &mut Plane<f32>,
    ) -> Result<(), RecordingError> {
        let metadata = self.metadata();
        let (shape, info) = (metadata.shape, metadata.require_channel(channel)?);
        require_image(&metadata.path, info, shape)?;
        let element = info.element;
        let mut bytes = Vec::new();
        self.read_raw(channel, index, &mut bytes)?;
        plane.reshape(shape, 0.0);
        element::decode_f32(element, ByteOrder::Little, &bytes, plane.values_mut());
        Ok(())
    }
}

/// Opens the recording at `path`, whatever its format.
///
/// # Errors
/// [`RecordingError::NotARecording`] for a path that holds none; otherwise what does not fit, by file.
pub fn open(path: &Path) -> Result<Box<dyn Recording>, RecordingError> {
    Ok(Box::new(native::NativeRecording::open(path)?))
}

fn require_image(path: &Path, channel: &ChannelInfo, shape: Shape) -> Result<(), RecordingError> {
    if channel.frame_dims == [shape.height, shape.width] {
        return Ok(());
    }
    Err(RecordingError::ChannelShape {
        file: path.join(format!("{}.npy", channel.name)),
        found: metadata::dims_text(&channel.frame_dims),
        expected: format!("an image of {shape}"),
        advice: String::new(),
    })
}
