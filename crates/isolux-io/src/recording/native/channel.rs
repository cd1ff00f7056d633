//! One channel of a native recording: an array in a file or in an archive, read frame by frame.

use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};

use super::gathered::GatheredFrames;
use super::mapped::MappedFrames;
use super::sequential::SequentialFrames;
use super::stream::{Packing, Section, SectionStream};
use crate::error::{RecordingError, dims_text};
use crate::recording::channels;
use crate::recording::element::ByteOrder;
use crate::recording::npy::{HeaderError, NpyHeader};
use crate::recording::source::{RawFrame, StoredChannel};

/// An array whose header has been read and whose size has been checked against the bytes that are there.
pub(crate) struct ArrayFile {
    pub(crate) name: String,
    /// For messages: the file, or ARCHIVE/MEMBER.
    pub(crate) path: PathBuf,
    pub(crate) header: NpyHeader,
    file: File,
    section: Section,
}

impl ArrayFile {
    /// Reads the header from `section` of `file`, a handle that nothing else reads from.
    pub(crate) fn open(
        name: String,
        path: PathBuf,
        file: File,
        section: Section,
    ) -> Result<Self, RecordingError> {
        let clone = file.try_clone().map_err(RecordingError::io("open", &path))?;
        let mut stream = SectionStream::new(clone, section).map_err(RecordingError::io("read", &path))?;
        let header = NpyHeader::read(&mut stream).map_err(|error| match error {
            HeaderError::Io(source) => read_error(&path, source),
            HeaderError::Content { found, expected } => RecordingError::content(&path, found, expected),
        })?;
        let array = Self { name, path, header, file, section };
        array.check_size()?;
        Ok(array)
    }

    /// Nothing is allocated before the claimed size has been found to be there.
    fn check_size(&self) -> Result<(), RecordingError> {
        let (header, found) = (&self.header, self.section.bytes);
        let expected = header.data_bytes().and_then(|bytes| bytes.checked_add(header.data_offset));
        if expected == Some(found) {
            return Ok(());
        }
        let expected = expected.map_or("more than can be counted".to_owned(), |bytes| bytes.to_string());
        let dims = dims_text(&header.dims);
        let expected = format!("{expected}, from its header: {dims} of {}", header.element);
        Err(RecordingError::content(&self.path, format!("{found} bytes"), expected))
    }

    /// The array as a channel of frames. Its first dimension must be the number of frames, and no dimension 0.
    /// `batch_bytes` bounds the memory for Fortran order.
    pub(crate) fn into_channel(self, batch_bytes: usize) -> Result<Channel, RecordingError> {
        let Self { name, path, header, file, section } = self;
        let (frame_count, frame_dims) = header.dims.split_first().map_or((1, &[][..]), |(n, d)| (*n, d));
        let size = header.element.size_bytes();
        let frame_bytes = channels::frame_values(&path, frame_dims)? * size;
        let mut note = Vec::new();
        note.extend((header.byte_order == ByteOrder::Big).then_some("big-endian"));
        note.extend(header.fortran_order.then_some("Fortran order"));
        note.extend((section.packing != Packing::Plain).then_some("deflated"));
        let start = header.data_offset;
        let frames = if header.is_c_order() && section.packing == Packing::Plain {
            Frames::Mapped(MappedFrames::new(file, section.start + start, frame_bytes, frame_count))
        } else {
            let stream = SectionStream::new(file, section).map_err(RecordingError::io("read", &path))?;
            if header.is_c_order() {
                Frames::Sequential(SequentialFrames::new(stream, start, frame_bytes))
            } else {
                Frames::Gathered(GatheredFrames::new(stream, start, &header.dims, size, batch_bytes))
            }
        };
        let frame_dims = frame_dims.to_vec();
        let stored = StoredChannel { name, path, element: header.element, frame_dims, note: note.join(", ") };
        Ok(Channel { stored, byte_order: header.byte_order, frames })
    }
}

#[derive(Debug)]
enum Frames {
    Mapped(MappedFrames),
    Sequential(SequentialFrames),
    Gathered(GatheredFrames),
}

/// A channel that is ready to be read.
#[derive(Debug)]
pub(crate) struct Channel {
    pub(crate) stored: StoredChannel,
    byte_order: ByteOrder,
    frames: Frames,
}

impl Channel {
    /// True where every frame takes the same time.
    pub(crate) fn is_random_access(&self) -> bool {
        matches!(self.frames, Frames::Mapped(_))
    }

    /// Makes `index`, which must be below the frame count, the current frame.
    pub(crate) fn load(&mut self, index: usize) -> Result<(), RecordingError> {
        let path = &self.stored.path;
        match &mut self.frames {
            Frames::Mapped(frames) => frames.load(index, path),
            Frames::Sequential(frames) => frames.load(index).map_err(|error| read_error(path, error)),
            Frames::Gathered(frames) => frames.load(index).map_err(|error| read_error(path, error)),
        }
    }

    /// The current frame, in C order, in the file's byte order; empty where there is none.
    pub(crate) fn raw(&self) -> RawFrame<'_> {
        let bytes = match &self.frames {
            Frames::Mapped(frames) => frames.bytes(),
            Frames::Sequential(frames) => frames.bytes(),
            Frames::Gathered(frames) => frames.bytes(),
        };
        let StoredChannel { element, frame_dims, .. } = &self.stored;
        RawFrame { element: *element, byte_order: self.byte_order, dims: frame_dims, bytes }
    }
}

/// Distinguishes damaged data from a refusal of the operating system.
fn read_error(path: &Path, source: io::Error) -> RecordingError {
    match source.kind() {
        io::ErrorKind::InvalidData | io::ErrorKind::InvalidInput | io::ErrorKind::UnexpectedEof => {
            RecordingError::content(path, format!("damaged data ({source})"), "a complete array")
        }
        _ => RecordingError::io("read", path)(source),
    }
}
