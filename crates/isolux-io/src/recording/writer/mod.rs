//! Writes native recordings frame by frame.

mod output;

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

use isolux::Shape;

use self::output::Output;
use super::element::{Element, ElementType};
use super::info::RecordingInfo;
use super::metadata::{ChannelInfo, dims_text};
use super::native::npy;
use crate::error::{RecordingError, listing};

/// A channel that is to be written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ChannelSpec {
    /// Its name; the file is `NAME.npy`.
    pub name: String,
    /// Type of its values.
    pub element: ElementType,
    /// Dimensions of one frame, all positive: `[]` one number, `[H, W]` an image.
    pub frame_dims: Vec<usize>,
}

impl ChannelSpec {
    /// A channel with one number for each frame.
    #[must_use]
    pub fn number(name: &str, element: ElementType) -> Self {
        Self { name: name.to_owned(), element, frame_dims: Vec::new() }
    }

    /// A channel with one image for each frame.
    #[must_use]
    pub fn image(name: &str, element: ElementType, shape: Shape) -> Self {
        Self { name: name.to_owned(), element, frame_dims: vec![shape.height, shape.width] }
    }

    /// A channel that takes what [`Recording::read_raw`](super::Recording::read_raw) reads from `channel`.
    #[must_use]
    pub fn copy_of(channel: &ChannelInfo) -> Self {
        Self { name: channel.name.clone(), element: channel.element, frame_dims: channel.frame_dims.clone() }
    }

    fn frame_bytes(&self) -> Option<usize> {
        self.frame_dims.iter().try_fold(self.element.size_bytes(), |bytes, &dim| bytes.checked_mul(dim))
    }
}

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
/// assert_eq!(isolux_io::open(&out)?.metadata().frame_count, 2);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct RecordingWriter {
    // Before the output: the files are closed before their folder is removed, which not every system allows
    // otherwise.
    channels: Vec<OpenChannel>,
    output: Output,
    frame_count: usize,
    bytes: Vec<u8>,
}

#[derive(Debug)]
struct OpenChannel {
    spec: ChannelSpec,
    frame_bytes: usize,
    path: PathBuf,
    file: BufWriter<File>,
    written: usize,
}

impl RecordingWriter {
    /// Starts a recording of `frame_count` frames at `path`.
    ///
    /// `overwrite` replaces a recording that is there, when the new one is finished; never anything else.
    ///
    /// # Errors
    /// [`RecordingError::Exists`], [`RecordingError::NotReplaced`], [`RecordingError::Write`] for channels that
    /// make no recording, [`RecordingError::Io`].
    pub fn create(
        path: &Path,
        frame_count: usize,
        channels: Vec<ChannelSpec>,
        overwrite: bool,
    ) -> Result<Self, RecordingError> {
        if frame_count == 0 || channels.is_empty() {
            let found = format!("{frame_count} frames of {} channels", channels.len());
            return Err(RecordingError::write(path, found, "at least one of each"));
        }
        for (position, spec) in channels.iter().enumerate() {
            check_spec(path, spec)?;
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
        Ok(Self { output, frame_count, channels, bytes: Vec::new() })
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
    /// [`Recording::read_raw`](super::Recording::read_raw) reads them.
    ///
    /// # Errors
    /// [`RecordingError::Write`] for an unknown channel, another number of bytes, or a frame too many;
    /// [`RecordingError::Io`].
    pub fn push_bytes(&mut self, channel: &str, bytes: &[u8]) -> Result<(), RecordingError> {
        let (path, frame_count) = (self.output.path().join(channel), self.frame_count);
        let channel = self.channel(channel)?;
        if channel.written == frame_count {
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

    /// Writes `recording.json` and gives the recording its name. Every channel must be complete.
    ///
    /// # Errors
    /// [`RecordingError::Write`] when frames are missing; [`RecordingError::Exists`] when something has come to
    /// be at the output meanwhile; [`RecordingError::Io`]. Nothing is left then.
    pub fn finish(self, info: &RecordingInfo) -> Result<(), RecordingError> {
        let path = self.output.path();
        if let Some(channel) = self.channels.iter().find(|channel| channel.written < self.frame_count) {
            let found = format!("{} frames", channel.written);
            let expected = format!("{}, as declared", self.frame_count);
            return Err(RecordingError::write(&path.join(&channel.spec.name), found, expected));
        }
        if info.integration_time_us.is_some()
            && self.channels.iter().any(|channel| channel.spec.name == "integration_time_us")
        {
            let found = "the channel `integration_time_us` and the constant of that name";
            return Err(RecordingError::write(path, found, "one of the two"));
        }
        let json = info.to_json(path)?;
        let mut names = Vec::new();
        for mut channel in self.channels {
            channel.file.flush().map_err(RecordingError::io("write", &channel.path))?;
            names.push(channel.spec.name);
        }
        self.output.publish(&names, &json)
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
    fn create(spec: ChannelSpec, frame_count: usize, folder: &Path) -> Result<Self, RecordingError> {
        let path = folder.join(format!("{}.npy", spec.name));
        let file = File::create_new(&path).map_err(RecordingError::io("create", &path))?;
        let mut file = BufWriter::with_capacity(1 << 16, file);
        let dims: Vec<_> = std::iter::once(frame_count).chain(spec.frame_dims.iter().copied()).collect();
        let header = npy::header_bytes(spec.element, &dims);
        file.write_all(&header).map_err(RecordingError::io("write", &path))?;
        let frame_bytes = spec.frame_bytes().unwrap_or(usize::MAX);
        Ok(Self { spec, frame_bytes, path, file, written: 0 })
    }
}

fn check_spec(path: &Path, spec: &ChannelSpec) -> Result<(), RecordingError> {
    let name = &spec.name;
    let plain = name.chars().all(|c| c.is_ascii_alphanumeric() || matches!(c, '_' | '-' | '.' | ' '));
    if name.is_empty() || name.starts_with('.') || !plain {
        let expected = "letters, digits, `_`, `-`, `.` or spaces, not beginning with `.`";
        return Err(RecordingError::write(path, format!("a channel named `{name}`"), expected));
    }
    if spec.frame_dims.contains(&0) || spec.frame_dims.len() > 16 || spec.frame_bytes().is_none() {
        let found = format!("frames of {}", dims_text(&spec.frame_dims));
        return Err(RecordingError::write(&path.join(name), found, "at most 16 positive dimensions"));
    }
    Ok(())
}
