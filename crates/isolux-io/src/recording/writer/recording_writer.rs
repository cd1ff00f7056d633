//! Takes frames, channel by channel, and writes each at once.

use std::fs::File;
use std::io::{BufWriter, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use isolux::RayTable;

use super::output::Output;
use super::spec::ChannelSpec;
use crate::error::{RecordingError, dims_text, listing};
use crate::recording::element::{Element, ElementType};
use crate::recording::info::RecordingInfo;
use crate::recording::npy;

/// Writes a recording: a folder, or an archive where the name ends in `.npz`. Everything is written under a
/// temporary name beside the output and renamed by [`finish`](Self::finish); a writer that is dropped before
/// leaves nothing.
///
/// ```
/// use isolux_io::{ChannelSpec, ElementType, RecordingInfo, RecordingWriter};
/// # let folder = tempfile::tempdir()?;
/// # let out = folder.path().join("recording");
/// let shape = isolux::Shape::new(2, 3);
/// let channels = vec![ChannelSpec::image("amplitude", ElementType::F32, shape)];
/// let mut writer = RecordingWriter::create(&out, 2, channels, false)?;
/// for frame in 0..2u8 {
///     writer.push("amplitude", &[f32::from(frame); 6])?;
/// }
/// writer.finish(&RecordingInfo::default())?;
/// assert_eq!(isolux_io::open(&out)?.metadata().frame_count, Some(2));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct RecordingWriter {
    // Before the output: the files are closed before their folder is removed, which not every system allows
    // otherwise.
    channels: Vec<OpenChannel>,
    output: Output,
    /// `None` until the end, where it is not known before.
    frame_count: Option<usize>,
    bytes: Vec<u8>,
    has_rays: bool,
}

/// Name of the array that is no channel: the rays of all pixels, once for all frames.
const RAYS: &str = "rays";

#[derive(Debug)]
struct OpenChannel {
    spec: ChannelSpec,
    header_bytes: usize,
    frame_bytes: usize,
    path: PathBuf,
    file: BufWriter<File>,
    written: usize,
}

impl RecordingWriter {
    /// Starts a recording of `frame_count` frames at `path`; of any number of frames, the same for all channels,
    /// where `frame_count` is `None`.
    ///
    /// `overwrite` replaces a recording that is there, when the new one is finished; never anything else.
    ///
    /// # Errors
    /// [`RecordingError::Exists`], [`RecordingError::NotReplaced`], [`RecordingError::Write`] for channels that
    /// make no recording, [`RecordingError::Io`].
    pub fn create(
        path: &Path,
        frame_count: impl Into<Option<usize>>,
        channels: Vec<ChannelSpec>,
        overwrite: bool,
    ) -> Result<Self, RecordingError> {
        let frame_count = frame_count.into();
        if frame_count == Some(0) || channels.is_empty() {
            return Err(nothing_to_write(path, frame_count, channels.len()));
        }
        for (position, spec) in channels.iter().enumerate() {
            spec.check(path)?;
            if channels[..position].iter().any(|earlier| earlier.name == spec.name) {
                let found = format!("two channels named `{}`", spec.name);
                return Err(RecordingError::write(path, found, "each name once"));
            }
        }
        let output = Output::create(path, overwrite)?;
        let channels = channels
            .into_iter()
            .map(|spec| OpenChannel::create(spec, frame_count, output.staging()))
            .collect::<Result<_, _>>()?;
        Ok(Self { output, frame_count, channels, bytes: Vec::new(), has_rays: false })
    }

    /// Writes the next frame of `channel`; `values` in C order, of the type that was declared.
    ///
    /// # Errors
    /// [`RecordingError::Write`] for an unknown channel, another type, another number of values, or a frame too
    /// many; [`RecordingError::Io`].
    pub fn push<T: Element>(&mut self, channel: &str, values: &[T]) -> Result<(), RecordingError> {
        let declared = self.channel(channel)?.spec.element;
        if declared != T::TYPE {
            let path = self.output.path().join(channel);
            return Err(RecordingError::write(&path, format!("values of type {}", T::TYPE), declared.name()));
        }
        let mut bytes = std::mem::take(&mut self.bytes);
        bytes.clear();
        T::append_little_endian(values, &mut bytes);
        let result = self.push_bytes(channel, &bytes);
        self.bytes = bytes;
        result
    }

    /// Writes the next frame of `channel` from little-endian bytes in C order, as
    /// [`Recording::read_raw`](crate::Recording::read_raw) reads them.
    ///
    /// # Errors
    /// [`RecordingError::Write`] for an unknown channel, another number of bytes, or a frame too many;
    /// [`RecordingError::Io`].
    pub fn push_bytes(&mut self, channel: &str, bytes: &[u8]) -> Result<(), RecordingError> {
        let (path, frame_count) = (self.output.path().join(channel), self.frame_count);
        let channel = self.channel(channel)?;
        if let Some(frame_count) = frame_count.filter(|&frame_count| channel.written == frame_count) {
            return Err(RecordingError::write(&path, "one frame more", format!("{frame_count} frames")));
        }
        if bytes.len() != channel.frame_bytes {
            let dims = dims_text(&channel.spec.frame_dims);
            let expected = format!("{}: {dims} of {}", channel.frame_bytes, channel.spec.element);
            return Err(RecordingError::write(&path, format!("a frame of {} bytes", bytes.len()), expected));
        }
        channel.file.write_all(bytes).map_err(RecordingError::io("write", &channel.path))?;
        channel.written += 1;
        Ok(())
    }

    /// Writes the table of rays, which all frames share, as the array `rays`: (H, W, 3), f64, of unit length.
    ///
    /// # Errors
    /// [`RecordingError::Write`] where there is a channel of that name or a table already; [`RecordingError::Io`].
    pub fn write_rays(&mut self, rays: &RayTable) -> Result<(), RecordingError> {
        if self.has_rays || self.channels.iter().any(|channel| channel.spec.name == RAYS) {
            return Err(RecordingError::write(
                self.output.path(),
                "two arrays named `rays`",
                "each name once",
            ));
        }
        let shape = rays.shape();
        let path = self.output.staging().join(format!("{RAYS}.npy"));
        let mut bytes = npy::header_bytes(ElementType::F64, &[shape.height, shape.width, 3], 0);
        rays.unit().iter().for_each(|ray| f64::append_little_endian(ray, &mut bytes));
        std::fs::write(&path, bytes).map_err(RecordingError::io("write", &path))?;
        self.has_rays = true;
        Ok(())
    }

    /// Writes `recording.json` and gives the recording its name. Every channel must be complete.
    ///
    /// # Errors
    /// [`RecordingError::Write`] when frames are missing; [`RecordingError::Exists`] when something has come to
    /// be at the output meanwhile; [`RecordingError::Io`]. Nothing is left then.
    pub fn finish(self, info: &RecordingInfo) -> Result<(), RecordingError> {
        let path = self.output.path();
        let frame_count = self.check_complete()?;
        if info.integration_time_us.is_some()
            && self.channels.iter().any(|channel| channel.spec.name == "integration_time_us")
        {
            let found = "the channel `integration_time_us` and the constant of that name";
            return Err(RecordingError::write(path, found, "one of the two"));
        }
        let json = info.to_json(path)?;
        let mut names = Vec::new();
        for channel in self.channels {
            let told_before = self.frame_count.is_some();
            names.push(channel.close((!told_before).then_some(frame_count))?);
        }
        names.extend(self.has_rays.then(|| RAYS.to_owned()));
        self.output.publish(&names, &json)
    }

    /// The number of frames that every channel has.
    fn check_complete(&self) -> Result<usize, RecordingError> {
        let path = self.output.path();
        let most = self.channels.iter().map(|channel| channel.written).max().unwrap_or(0);
        let frame_count = self.frame_count.unwrap_or(most);
        if frame_count == 0 {
            return Err(nothing_to_write(path, Some(0), self.channels.len()));
        }
        let Some(channel) = self.channels.iter().find(|channel| channel.written < frame_count) else {
            return Ok(frame_count);
        };
        let why = if self.frame_count.is_some() { "as declared" } else { "as of the other channels" };
        let found = format!("{} frames", channel.written);
        Err(RecordingError::write(&path.join(&channel.spec.name), found, format!("{frame_count}, {why}")))
    }

    fn channel(&mut self, name: &str) -> Result<&mut OpenChannel, RecordingError> {
        let Some(position) = self.channels.iter().position(|channel| channel.spec.name == name) else {
            let declared = listing(self.channels.iter().map(|channel| channel.spec.name.as_str()));
            return Err(RecordingError::write(self.output.path(), format!("channel `{name}`"), declared));
        };
        Ok(&mut self.channels[position])
    }
}

impl OpenChannel {
    fn create(spec: ChannelSpec, frame_count: Option<usize>, folder: &Path) -> Result<Self, RecordingError> {
        let path = folder.join(format!("{}.npy", spec.name));
        let file = File::create_new(&path).map_err(RecordingError::io("create", &path))?;
        let mut file = BufWriter::with_capacity(1 << 16, file);
        // Of a number that is not known, the largest one: room for the one that will be.
        let header = header(&spec, frame_count.unwrap_or(usize::MAX), 0);
        file.write_all(&header).map_err(RecordingError::io("write", &path))?;
        let frame_bytes = spec.frame_bytes().unwrap_or(usize::MAX);
        Ok(Self { spec, header_bytes: header.len(), frame_bytes, path, file, written: 0 })
    }

    /// Writes what is left, and the number of frames into the header where it was not known before; gives back the
    /// channel's name.
    fn close(mut self, frame_count: Option<usize>) -> Result<String, RecordingError> {
        let mut close = || {
            if let Some(frame_count) = frame_count {
                self.file.seek(SeekFrom::Start(0))?;
                self.file.write_all(&header(&self.spec, frame_count, self.header_bytes))?;
            }
            self.file.flush()
        };
        close().map_err(RecordingError::io("write", &self.path))?;
        Ok(self.spec.name)
    }
}

fn header(spec: &ChannelSpec, frame_count: usize, least_bytes: usize) -> Vec<u8> {
    let dims: Vec<_> = std::iter::once(frame_count).chain(spec.frame_dims.iter().copied()).collect();
    npy::header_bytes(spec.element, &dims, least_bytes)
}

fn nothing_to_write(path: &Path, frame_count: Option<usize>, channels: usize) -> RecordingError {
    let frames = frame_count.map_or("any number of".to_owned(), |count| count.to_string());
    RecordingError::write(path, format!("{frames} frames of {channels} channels"), "at least one of each")
}
