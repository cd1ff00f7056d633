//! A recording in the native format, as a source of channels.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use isolux::RayTable;

use super::channel::Channel;
use super::find::find_arrays;
use super::{rays, shapes};
use crate::error::RecordingError;
use crate::recording::info::RecordingInfo;
use crate::recording::metadata::Access;
use crate::recording::source::{ChannelSource, RawFrame, SourceDescription};

/// Memory for all channels in Fortran order together.
const GATHERED_BYTES: usize = 96 << 20;

/// A recording in the native format, open for reading.
#[derive(Debug)]
pub(crate) struct NativeSource {
    path: PathBuf,
    frame_count: usize,
    channels: Vec<Channel>,
    info: RecordingInfo,
    info_path: PathBuf,
    rays: Option<Arc<RayTable>>,
}

impl NativeSource {
    /// Opens a folder or an archive: reads the headers, checks that all arrays have the same number of frames,
    /// reads no values but those of a table of rays.
    pub(crate) fn open(path: &Path) -> Result<Self, RecordingError> {
        let (mut arrays, info_path) = find_arrays(path)?;
        let rays = rays::take(&mut arrays)?;
        let info = RecordingInfo::read_if_present(&info_path)?;
        let frame_count = shapes::check(path, &arrays)?;
        let gathered = arrays.iter().filter(|array| !array.header.is_c_order()).count();
        let batch_bytes = GATHERED_BYTES / gathered.max(1);
        let channels =
            arrays.into_iter().map(|array| array.into_channel(batch_bytes)).collect::<Result<Vec<_>, _>>()?;
        Ok(Self { path: path.to_owned(), frame_count, channels, info, info_path, rays })
    }
}

impl ChannelSource for NativeSource {
    fn describe(&self) -> SourceDescription {
        let random = self.channels.iter().all(Channel::is_random_access);
        SourceDescription {
            path: self.path.clone(),
            frame_count: Some(self.frame_count),
            access: if random { Access::Random } else { Access::Rewindable },
            channels: self.channels.iter().map(|channel| channel.stored.clone()).collect(),
            info: self.info.clone(),
            info_path: self.info_path.clone(),
        }
    }

    fn rays(&self) -> Option<Arc<RayTable>> {
        self.rays.clone()
    }

    /// Each channel stands where it was read last, so that frames and channels that nobody wants cost nothing, and
    /// [`rewind`](ChannelSource::rewind) has nothing to do.
    fn load(&mut self, index: usize, channels: &[usize]) -> Result<bool, RecordingError> {
        if index >= self.frame_count {
            return Ok(false);
        }
        channels.iter().try_for_each(|&channel| self.channels[channel].load(index))?;
        Ok(true)
    }

    fn raw(&self, channel: usize) -> RawFrame<'_> {
        self.channels[channel].raw()
    }
}
