//! The native format: a folder of `.npy` files, or one `.npz`.

mod archive;
mod channel;
mod folder;
mod frames;
mod gathered;
mod literal;
mod mapped;
pub(crate) mod npy;
mod reader;
mod sequential;
mod stream;

use std::path::{Path, PathBuf};

use isolux::{Channels, Frame, Plane};

use self::channel::{ArrayFile, Channel};
use self::frames::Scratch;
use super::element::{ElementType, append_as_little_endian, decode_f32};
use super::info::RecordingInfo;
use super::layout::{self, ArrayShape, Layout};
use super::metadata::{ChannelInfo, Metadata, Storage};
use super::{Recording, require_image};
use crate::error::RecordingError;

/// Memory for all channels in Fortran order together.
const GATHERED_BYTES: usize = 96 << 20;

/// A recording in the native format, open for reading.
pub(crate) struct NativeRecording {
    metadata: Metadata,
    channels: Vec<Channel>,
    scratch: Scratch,
}

impl NativeRecording {
    /// Opens a folder or an archive: reads the headers, checks that they make one recording, reads no values.
    pub(crate) fn open(path: &Path) -> Result<Self, RecordingError> {
        let (arrays, info_path) = find_arrays(path)?;
        let info = RecordingInfo::read_if_present(&info_path)?;
        let shapes: Vec<_> = arrays
            .iter()
            .map(|array| ArrayShape {
                name: &array.name,
                path: array.path.clone(),
                element: array.header.element,
                dims: &array.header.dims,
            })
            .collect();
        let layout = layout::check(path, &shapes, &info, &info_path)?;
        let gathered = arrays.iter().filter(|array| !array.header.is_c_order()).count();
        let batch_bytes = GATHERED_BYTES / gathered.max(1);
        let channels =
            arrays.into_iter().map(|array| array.into_channel(batch_bytes)).collect::<Result<Vec<_>, _>>()?;
        let metadata = Metadata {
            path: path.to_owned(),
            frame_count: layout.frame_count,
            shape: layout.shape,
            channels: list_channels(&channels, &layout, &info),
            available: layout.available,
            info,
        };
        Ok(Self { metadata, channels, scratch: Scratch::default() })
    }

    fn stored(&mut self, name: &str, index: usize) -> Result<&mut Channel, RecordingError> {
        self.metadata.check_frame(index)?;
        self.metadata.require_channel(name)?;
        let position = self.channels.iter().position(|channel| channel.name == name);
        // Not reached: the metadata list every channel.
        let absent = || RecordingError::content(&self.metadata.path, "nothing", name);
        position.map(|position| &mut self.channels[position]).ok_or_else(absent)
    }
}

impl Recording for NativeRecording {
    fn metadata(&self) -> &Metadata {
        &self.metadata
    }

    fn read_frame(
        &mut self,
        index: usize,
        wanted: Channels,
        frame: &mut Frame,
    ) -> Result<(), RecordingError> {
        self.metadata.check_frame(index)?;
        frames::read(&self.metadata, &mut self.channels, &mut self.scratch, index, wanted, frame)
    }

    fn read_raw(&mut self, channel: &str, index: usize, bytes: &mut Vec<u8>) -> Result<(), RecordingError> {
        let channel = self.stored(channel, index)?;
        let (element, order) = (channel.element, channel.byte_order);
        bytes.clear();
        append_as_little_endian(element, order, channel.frame(index)?, bytes);
        Ok(())
    }

    fn read_plane(
        &mut self,
        channel: &str,
        index: usize,
        plane: &mut Plane<f32>,
    ) -> Result<(), RecordingError> {
        let shape = self.metadata.shape;
        require_image(&self.metadata.path, self.metadata.require_channel(channel)?, shape)?;
        let channel = self.stored(channel, index)?;
        let (element, order) = (channel.element, channel.byte_order);
        plane.reshape(shape, 0.0);
        decode_f32(element, order, channel.frame(index)?, plane.values_mut());
        Ok(())
    }
}

/// The arrays of the recording at `path`, by name, and where its `recording.json` would be.
fn find_arrays(path: &Path) -> Result<(Vec<ArrayFile>, PathBuf), RecordingError> {
    let metadata = std::fs::metadata(path).map_err(RecordingError::io("open", path))?;
    let not = |found: String| RecordingError::NotARecording { path: path.to_owned(), found };
    if metadata.is_dir() {
        let contents = folder::list(path)?;
        return match (contents.arrays.is_empty(), contents.has_archive) {
            (false, false) => Ok((folder::open_arrays(contents.arrays)?, path.join("recording.json"))),
            (true, true) => {
                Ok((archive::open_arrays(&path.join("recording.npz"))?, path.join("recording.json")))
            }
            (false, true) => {
                Err(not("both .npy files and recording.npz; move one of the two away".to_owned()))
            }
            (true, false) => Err(not(format!("a folder with {}", contents.others))),
        };
    }
    if !metadata.is_file() {
        return Err(not("neither a file nor a folder".to_owned()));
    }
    match path.extension().and_then(|extension| extension.to_str()) {
        Some("npz") => Ok((archive::open_arrays(path)?, path.with_extension("json"))),
        Some("npy" | "json") => Err(not("one file of a recording; give its folder".to_owned())),
        _ => Err(not("a file without .npz at the end of its name".to_owned())),
    }
}

fn list_channels(channels: &[Channel], layout: &Layout, info: &RecordingInfo) -> Vec<ChannelInfo> {
    let mut list: Vec<_> = channels
        .iter()
        .map(|channel| ChannelInfo {
            name: channel.name.clone(),
            element: channel.element,
            frame_dims: channel.frame_dims.clone(),
            storage: channel.storage,
        })
        .collect();
    let image = vec![layout.shape.height, layout.shape.width];
    let stored = |name: &str| channels.iter().any(|channel| channel.name == name);
    for (name, flag) in [("amplitude", Channels::AMPLITUDE), ("distance", Channels::DISTANCE)] {
        if layout.available.contains(flag) && !stored(name) {
            list.push(ChannelInfo {
                name: name.to_owned(),
                element: ElementType::F32,
                frame_dims: image.clone(),
                storage: Storage::FromPhaseSamples,
            });
        }
    }
    if info.integration_time_us.is_some() {
        list.push(ChannelInfo {
            name: "integration_time_us".to_owned(),
            element: ElementType::F64,
            frame_dims: Vec::new(),
            storage: Storage::Constant,
        });
    }
    list
}
