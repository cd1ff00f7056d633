//! Reads and writes recordings of time-of-flight cameras, and calibration files.
//!
//! A recording is a sequence of frames of one camera. Everything goes frame by frame: a recording never has to fit in
//! memory.
//!
//! # Reading
//!
//! [`open`] recognizes the format of a path and returns a [`Recording`]. Its [`Metadata`] hold the shape, the
//! channels and, where the format states it beforehand, the number of frames. [`for_each_frame`] goes through a
//! recording of any length; [`Recording::read_frame`] reads one frame by its number. Frames come in the units of
//! [`isolux::Frame`], whatever is stored: distances in metres and radial, amplitudes from the phase samples where
//! only those are recorded, and pixels without a measurement are flagged.
//!
//! ```
//! # let folder = tempfile::tempdir()?;
//! # let path = folder.path().join("recording");
//! use isolux::{Channels, Shape};
//! use isolux_io::{ChannelSpec, ElementType, RecordingError, RecordingInfo, RecordingWriter};
//!
//! // Writing: name the channels, push each frame of each, finish. Where the number of frames is not known
//! // beforehand, it is `None`.
//! let shape = Shape::new(1, 2);
//! let image = |name| ChannelSpec::image(name, ElementType::U16, shape);
//! let channels = vec![image("amplitude"), image("distance")];
//! let mut writer = RecordingWriter::create(&path, None, channels, false)?;
//! for frame in 1..=3u16 {
//!     writer.push("amplitude", &[100 * frame, 0])?;
//!     writer.push("distance", &[1500u16, 0])?;
//! }
//! writer.finish(&RecordingInfo { camera: Some("example".to_owned()), ..RecordingInfo::default() })?;
//!
//! // Reading: integers are millimetres unless the recording says otherwise, and an amplitude of 0 is no measurement.
//! let mut recording = isolux_io::open(&path)?;
//! let wanted = Channels::AMPLITUDE | Channels::DISTANCE;
//! let frames = isolux_io::for_each_frame(&mut *recording, wanted, |index, frame| {
//!     assert_eq!(frame.amplitude.values()[0], 100.0 * (index + 1) as f32);
//!     assert!(frame.is_valid(0) && !frame.is_valid(1));
//!     assert_eq!(frame.distance_m.as_ref().map(|distances| distances.values()[0]), Some(1.5));
//!     Ok::<(), RecordingError>(())
//! })?;
//! assert_eq!(frames, 3);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Writing
//!
//! [`RecordingWriter`] writes the native format: a folder of `.npy` files, or one `.npz`. The output appears whole,
//! under its name, when [`RecordingWriter::finish`] returns, or not at all.
//!
//! # A further format
//!
//! A format implements [`ChannelSource`]: it describes its channels, brings one frame after the other into memory, and
//! lends the bytes as they are, in the type and byte order that it has them in. [`Assembled`] makes a [`Recording`] of
//! it and does what is the same for all formats: units, radial distances, phase samples, flags, and the checks of shapes
//! and values. A source may know neither how many frames will come nor how to go back; [`recording::Access`] says what
//! it can do. Within this crate, one line in `recording::open` adds the format to those that [`open`] knows.
//!
//! ```
//! use std::path::PathBuf;
//!
//! use isolux::{Channels, Frame};
//! use isolux_io::recording::{Access, RawFrame, SourceDescription, StoredChannel};
//! use isolux_io::{Assembled, ChannelSource, ElementType, Recording, RecordingError, RecordingInfo};
//!
//! /// Images of 1×2 pixels that arrive one by one.
//! struct Live {
//!     arriving: std::vec::IntoIter<[u16; 2]>,
//!     /// The current image and its number.
//!     current: Option<(usize, [u16; 2])>,
//! }
//!
//! impl ChannelSource for Live {
//!     fn describe(&self) -> SourceDescription {
//!         let amplitude = StoredChannel {
//!             name: "amplitude".to_owned(),
//!             path: PathBuf::from("live/amplitude"),
//!             element: ElementType::U16,
//!             frame_dims: vec![1, 2],
//!             note: String::new(),
//!         };
//!         SourceDescription {
//!             path: PathBuf::from("live"),
//!             frame_count: None,
//!             access: Access::Once,
//!             channels: vec![amplitude],
//!             // The code that this camera delivers for saturated pixels.
//!             info: RecordingInfo { saturated_amplitude: Some(4095.0), ..RecordingInfo::default() },
//!             info_path: PathBuf::from("live"),
//!         }
//!     }
//!
//!     fn load(&mut self, index: usize, _channels: &[usize]) -> Result<bool, RecordingError> {
//!         // Asked for the current frame once more, or for the next one.
//!         if self.current.is_none_or(|(current, _)| current != index) {
//!             self.current = self.arriving.next().map(|image| (index, image));
//!         }
//!         Ok(self.current.is_some())
//!     }
//!
//!     fn raw(&self, _channel: usize) -> RawFrame<'_> {
//!         let values = self.current.as_ref().map_or(&[][..], |(_, image)| image);
//!         RawFrame::of(&[1, 2], values)
//!     }
//! }
//!
//! let live = Live { arriving: vec![[7, 4095], [8, 9]].into_iter(), current: None };
//! let mut recording = Assembled::new(live)?;
//! let mut frame = Frame::new(recording.metadata().shape);
//! let mut valid = Vec::new();
//! while recording.read_frame_if_there(valid.len(), Channels::AMPLITUDE, &mut frame)? {
//!     valid.push([frame.is_valid(0), frame.is_valid(1)]);
//! }
//! assert_eq!(valid, [[true, false], [true, true]]);
//! # Ok::<(), RecordingError>(())
//! ```
//!
//! # Calibration files
//!
//! [`read_calibration`] and [`write_calibration`] keep a [`isolux::Calibration`] as JSON.

pub mod calibration_file;
pub mod error;
pub mod recording;
mod whole_file;

pub use calibration_file::{CalibrationFileError, read_calibration, write_calibration};
pub use error::RecordingError;
pub use recording::{
    Assembled, ChannelSource, ChannelSpec, ElementType, Metadata, Recording, RecordingInfo, RecordingWriter,
    for_each_frame, open,
};
pub use whole_file::write_whole;
