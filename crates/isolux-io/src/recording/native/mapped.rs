//! Frames of an uncompressed array, through windows of memory mapped onto the file.

use std::fs::File;
use std::path::Path;

use memmap2::{Mmap, MmapOptions};

use crate::error::RecordingError;

/// Touched pages of a mapping count as the process's memory, so the window stays small however long the file is;
/// 8 MiB makes the cost of mapping negligible beside that of reading.
const WINDOW_BYTES: usize = 8 << 20;

/// Frames that lie one behind the other in a file.
#[derive(Debug)]
pub(crate) struct MappedFrames {
    file: File,
    /// Byte of the first frame.
    start: u64,
    frame_bytes: usize,
    frame_count: usize,
    window: Option<(usize, Mmap)>,
    /// Byte of the current frame in the window.
    begin: usize,
}

impl MappedFrames {
    pub(crate) fn new(file: File, start: u64, frame_bytes: usize, frame_count: usize) -> Self {
        Self { file, start, frame_bytes, frame_count, window: None, begin: 0 }
    }

    /// Makes `index`, which must be below the frame count, the current frame.
    pub(crate) fn load(&mut self, index: usize, path: &Path) -> Result<(), RecordingError> {
        let frames_per_window = (WINDOW_BYTES / self.frame_bytes).max(1);
        let first = index - index % frames_per_window;
        if self.window.as_ref().is_none_or(|window| window.0 != first) {
            // Unmapped before the next one is mapped: two windows at once would count twice.
            self.window = None;
            let frames = frames_per_window.min(self.frame_count - first);
            self.window = Some((first, self.map(first, frames, path)?));
        }
        self.begin = (index - first) * self.frame_bytes;
        Ok(())
    }

    /// The bytes of the current frame; empty before the first one.
    pub(crate) fn bytes(&self) -> &[u8] {
        match &self.window {
            Some((_, window)) => &window[self.begin..self.begin + self.frame_bytes],
            None => &[],
        }
    }

    fn map(&self, first: usize, frames: usize, path: &Path) -> Result<Mmap, RecordingError> {
        let length = frames * self.frame_bytes;
        let offset = self.start + first as u64 * self.frame_bytes as u64;
        let found = self.file.metadata().map_err(RecordingError::io("look at", path))?.len();
        let expected = offset + length as u64;
        if found < expected {
            let found = format!("{found} bytes, fewer than when it was opened");
            return Err(RecordingError::content(path, found, format!("at least {expected}")));
        }
        // SAFETY: the mapping is read-only and private to this process's reading. The remaining hazard is another
        // process that shortens or rewrites the file while the window is mapped: then the bytes may change under
        // the borrow, or the access may end the process with SIGBUS. No format can rule that out; the size was
        // checked just now, windows live shortly, and our own writer never changes a finished file in place.
        unsafe { MmapOptions::new().offset(offset).len(length).map(&self.file) }
            .map_err(RecordingError::io("map", path))
    }
}

#[cfg(test)]
mod tests {
    use std::io::Write;

    use super::*;

    #[test]
    fn frames_of_any_size_are_found_across_windows() {
        let start = 77;
        for frame_bytes in [1, WINDOW_BYTES / 3, WINDOW_BYTES + 5] {
            let mut file = tempfile::tempfile().unwrap();
            file.write_all(&[0xee; 77]).unwrap();
            (0..5u8).for_each(|frame| file.write_all(&vec![frame; frame_bytes]).unwrap());
            let mut frames = MappedFrames::new(file, start, frame_bytes, 5);
            for index in [0, 1, 2, 3, 4, 2, 0, 4] {
                frames.load(index, Path::new("test")).unwrap();
                let frame = frames.bytes();
                assert!(frame.len() == frame_bytes && frame.iter().all(|&byte| usize::from(byte) == index));
            }
        }
    }
}
