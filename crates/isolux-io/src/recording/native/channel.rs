//! One channel of a native recording: an array in a file or in an archive, read frame by frame.

use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};

use super::gathered::GatheredFrames;
use super::mapped::MappedFrames;
use super::npy::{HeaderError, NpyHeader};
use super::sequential::SequentialFrames;
use super::stream::{Packing, Section, SectionStream};
use crate::error::RecordingError;
use crate::recording::element::{ByteOrder, ElementType};
use crate::recording::metadata::{Storage, dims_text};

/// The largest cameras have a few million pixels: a claim of more than this is damage, or an attack on memory.
const MOST_FRAME_VALUES: u64 = 1 << 26;

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
        let values = frame_dims.iter().try_fold(1u64, |product, &dim| product.checked_mul(dim as u64));
        let values = values.filter(|&values| values <= MOST_FRAME_VALUES).ok_or_else(|| {
            let found = format!("frames of {}", dims_text(frame_dims));
            RecordingError::content(&path, found, format!("at most {MOST_FRAME_VALUES} values in a frame"))
        })?;
        let frame_bytes = values as usize * size;
        let storage = Storage::File {
            byte_order: header.byte_order,
            fortran_order: header.fortran_order,
            deflated: section.packing != Packing::Plain,
        };
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
        Ok(Channel {
            name,
            element: header.element,
            byte_order: header.byte_order,
            frame_dims: frame_dims.to_vec(),
            storage,
            path,
            frames,
        })
    }
}

enum Frames {
    Mapped(MappedFrames),
    Sequential(SequentialFrames),
    Gathered(GatheredFrames),
}

/// A channel that is ready to be read.
pub(crate) struct Channel {
    pub(crate) name: String,
    pub(crate) element: ElementType,
    pub(crate) byte_order: ByteOrder,
    pub(crate) frame_dims: Vec<usize>,
    pub(crate) storage: Storage,
    pub(crate) path: PathBuf,
    frames: Frames,
}

impl Channel {
    /// The bytes of one frame, in C order, in the file's byte order. `index` must be below the frame count.
    pub(crate) fn frame(&mut self, index: usize) -> Result<&[u8], RecordingError> {
        match &mut self.frames {
            Frames::Mapped(frames) => frames.frame(index, &self.path),
            Frames::Sequential(frames) => frames.frame(index).map_err(|error| read_error(&self.path, error)),
            Frames::Gathered(frames) => frames.frame(index).map_err(|error| read_error(&self.path, error)),
        }
    }
}

/// Tells damaged data from a system that refuses.
fn read_error(path: &Path, source: io::Error) -> RecordingError {
    match source.kind() {
        io::ErrorKind::InvalidData | io::ErrorKind::InvalidInput | io::ErrorKind::UnexpectedEof => {
            RecordingError::content(path, format!("damaged data ({source})"), "a complete array")
        }
        _ => RecordingError::io("read", path)(source),
    }
}
