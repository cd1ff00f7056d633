//! The bytes of a file's section from front to back, decompressed where they are deflated.

use std::fs::File;
use std::io::{self, BufReader, Read, Seek, SeekFrom, Take};

use flate2::Crc;
use flate2::read::DeflateDecoder;

/// Where an array's `.npy` bytes lie in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Section {
    /// First byte in the file.
    pub(crate) start: u64,
    /// Bytes in the file.
    pub(crate) stored_bytes: u64,
    /// Bytes after decompression.
    pub(crate) bytes: u64,
    pub(crate) packing: Packing,
}

/// How a section's bytes are packed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Packing {
    Plain,
    /// Deflated, with the CRC-32 of the decompressed bytes.
    Deflate {
        crc32: u32,
    },
}

type Bytes = BufReader<Take<File>>;

#[derive(Debug)]
enum Source {
    Plain(Bytes),
    Deflate(DeflateDecoder<Bytes>, Crc),
}

/// Reads a section in order; going back starts anew.
#[derive(Debug)]
pub(crate) struct SectionStream {
    file: File,
    section: Section,
    source: Source,
    position: u64,
}

impl SectionStream {
    /// A stream at the section's first byte. `file` must not be read through another handle that shares its
    /// position.
    pub(crate) fn new(file: File, section: Section) -> io::Result<Self> {
        let source = source(&file, section)?;
        Ok(Self { file, section, source, position: 0 })
    }

    /// Moves to byte `position` of the decompressed section.
    pub(crate) fn seek_to(&mut self, position: u64) -> io::Result<()> {
        if position < self.position {
            self.source = source(&self.file, self.section)?;
            self.position = 0;
        }
        match &mut self.source {
            Source::Plain(bytes) => {
                bytes.seek_relative((position - self.position) as i64)?;
                self.position = position;
            }
            Source::Deflate(..) => {
                let mut skipped = [0; 8192];
                while self.position < position {
                    let step = (position - self.position).min(skipped.len() as u64) as usize;
                    self.read_exact(&mut skipped[..step])?;
                }
            }
        }
        Ok(())
    }
}

impl Read for SectionStream {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = match &mut self.source {
            Source::Plain(bytes) => bytes.read(buffer)?,
            Source::Deflate(decoder, crc) => {
                let count = decoder.read(buffer)?;
                crc.update(&buffer[..count]);
                count
            }
        };
        self.position += count as u64;
        match (&self.source, self.section.packing) {
            (Source::Deflate(_, crc), Packing::Deflate { crc32 })
                if self.position == self.section.bytes && crc.sum() != crc32 =>
            {
                Err(io::Error::new(io::ErrorKind::InvalidData, "the checksum does not fit: damaged data"))
            }
            _ => Ok(count),
        }
    }
}

fn source(file: &File, section: Section) -> io::Result<Source> {
    let mut file = file.try_clone()?;
    file.seek(SeekFrom::Start(section.start))?;
    let bytes = BufReader::with_capacity(1 << 16, file.take(section.stored_bytes));
    Ok(match section.packing {
        Packing::Plain => Source::Plain(bytes),
        Packing::Deflate { .. } => Source::Deflate(DeflateDecoder::new(bytes), Crc::new()),
    })
}
