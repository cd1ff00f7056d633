//! Frames of a deflated array in C order: decoded from front to back, one at a time.

use std::io::{self, Read};

use super::stream::SectionStream;

/// Frames behind a decoder. Ascending reads decode each byte once; going back starts anew.
#[derive(Debug)]
pub(crate) struct SequentialFrames {
    stream: SectionStream,
    /// Byte of the first frame.
    start: u64,
    frame_bytes: usize,
    buffer: Vec<u8>,
    current: Option<usize>,
}

impl SequentialFrames {
    pub(crate) fn new(stream: SectionStream, start: u64, frame_bytes: usize) -> Self {
        Self { stream, start, frame_bytes, buffer: Vec::new(), current: None }
    }

    /// Makes `index` the current frame.
    pub(crate) fn load(&mut self, index: usize) -> io::Result<()> {
        if self.current != Some(index) {
            self.current = None;
            self.stream.seek_to(self.start + index as u64 * self.frame_bytes as u64)?;
            read_into(&mut self.stream, self.frame_bytes, &mut self.buffer)?;
            self.current = Some(index);
        }
        Ok(())
    }

    /// The bytes of the current frame.
    pub(crate) fn bytes(&self) -> &[u8] {
        &self.buffer
    }
}

/// Reads exactly `bytes` into `buffer`. The buffer grows with what is really there, never by a claim alone.
pub(crate) fn read_into(stream: &mut SectionStream, bytes: usize, buffer: &mut Vec<u8>) -> io::Result<()> {
    if buffer.len() == bytes {
        return stream.read_exact(buffer);
    }
    buffer.clear();
    let found = stream.take(bytes as u64).read_to_end(buffer)?;
    if found < bytes {
        let message = format!("{found} of {bytes} bytes are there: truncated data");
        return Err(io::Error::new(io::ErrorKind::UnexpectedEof, message));
    }
    Ok(())
}
