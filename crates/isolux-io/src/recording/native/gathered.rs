//! Frames of an array in Fortran order, where the frame index varies fastest and one frame lies scattered over
//! the whole file: one pass from front to back gathers as many neighbouring frames as memory allows.

use std::io;

use super::sequential::read_into;
use super::stream::SectionStream;

/// Bytes read at once, unless one pixel of all frames takes more.
const BLOCK_BYTES: usize = 1 << 20;

/// Frames gathered in batches.
#[derive(Debug)]
pub(crate) struct GatheredFrames {
    stream: SectionStream,
    /// Byte of the first value.
    start: u64,
    frame_count: usize,
    frame_dims: Vec<usize>,
    element_bytes: usize,
    frames_per_batch: usize,
    /// The first frame of the batch.
    first: Option<usize>,
    batch: Vec<u8>,
    block: Vec<u8>,
    /// Byte of the current frame in the batch.
    begin: usize,
}

impl GatheredFrames {
    /// `dims` are those of the whole array, frames first; a batch takes at most `batch_bytes`, but holds at least
    /// one frame.
    pub(crate) fn new(
        stream: SectionStream,
        start: u64,
        dims: &[usize],
        element_bytes: usize,
        batch_bytes: usize,
    ) -> Self {
        let (frame_count, frame_dims) = dims.split_first().map_or((0, Vec::new()), |(n, d)| (*n, d.to_vec()));
        let frame_bytes = frame_dims.iter().product::<usize>() * element_bytes;
        let frames_per_batch = (batch_bytes / frame_bytes.max(1)).clamp(1, frame_count.max(1));
        Self {
            stream,
            start,
            frame_count,
            frame_dims,
            element_bytes,
            frames_per_batch,
            first: None,
            batch: Vec::new(),
            block: Vec::new(),
            begin: 0,
        }
    }

    /// Makes `index` the current frame.
    pub(crate) fn load(&mut self, index: usize) -> io::Result<()> {
        let first = index - index % self.frames_per_batch;
        if self.first != Some(first) {
            self.first = None;
            self.gather(first)?;
            self.first = Some(first);
        }
        self.begin = (index - first) * self.frame_bytes();
        Ok(())
    }

    /// The bytes of the current frame in C order; empty before the first one.
    pub(crate) fn bytes(&self) -> &[u8] {
        self.batch.get(self.begin..self.begin + self.frame_bytes()).unwrap_or_default()
    }

    fn frame_bytes(&self) -> usize {
        self.frame_dims.iter().product::<usize>() * self.element_bytes
    }

    /// Reads the whole array once. It lies there as one column for each pixel: its values in all frames.
    fn gather(&mut self, first: usize) -> io::Result<()> {
        let frames = self.frames_per_batch.min(self.frame_count - first);
        let (size, frame_bytes) = (self.element_bytes, self.frame_bytes());
        self.batch.clear();
        self.batch
            .try_reserve_exact(frames * frame_bytes)
            .map_err(|error| io::Error::new(io::ErrorKind::OutOfMemory, error))?;
        self.batch.resize(frames * frame_bytes, 0);

        let (columns, column_bytes) = (frame_bytes / size, self.frame_count * size);
        let columns_per_block = (BLOCK_BYTES / column_bytes).clamp(1, columns);
        self.stream.seek_to(self.start)?;
        for block_first in (0..columns).step_by(columns_per_block) {
            let count = columns_per_block.min(columns - block_first);
            read_into(&mut self.stream, count * column_bytes, &mut self.block)?;
            for (column, values) in (block_first..).zip(self.block.chunks_exact(column_bytes)) {
                let wanted = &values[first * size..(first + frames) * size];
                let out = &mut self.batch[c_position(column, &self.frame_dims) * size..];
                match size {
                    1 => scatter::<1>(wanted, frame_bytes, out),
                    2 => scatter::<2>(wanted, frame_bytes, out),
                    4 => scatter::<4>(wanted, frame_bytes, out),
                    _ => scatter::<8>(wanted, frame_bytes, out),
                }
            }
        }
        Ok(())
    }
}

/// Copies value k of `column` to byte `k * stride` of `out`.
fn scatter<const SIZE: usize>(column: &[u8], stride: usize, out: &mut [u8]) {
    for (k, value) in column.as_chunks::<SIZE>().0.iter().enumerate() {
        out[k * stride..k * stride + SIZE].copy_from_slice(value);
    }
}

/// The place in C order, last index fastest, of what is at place `rest` in Fortran order, first index fastest.
fn c_position(mut rest: usize, dims: &[usize]) -> usize {
    dims.iter().fold(0, |position, &dim| {
        let index = rest % dim;
        rest /= dim;
        position * dim + index
    })
}

#[cfg(test)]
mod tests {
    use std::io::Write;

    use super::super::stream::{Packing, Section};
    use super::*;

    #[test]
    fn places_in_fortran_order_have_their_places_in_c_order() {
        let places: Vec<_> = (0..6).map(|place| c_position(place, &[2, 3])).collect();
        assert_eq!(places, [0, 3, 1, 4, 2, 5]);
        assert_eq!(c_position(0, &[]), 0);
    }

    #[test]
    fn batches_of_any_size_give_the_same_frames() {
        // Frame n, row h, column w holds 100 n + 10 h + w.
        let (frames, height, width) = (7u16, 3u16, 2u16);
        let mut file = tempfile::tempfile().unwrap();
        for w in 0..width {
            for h in 0..height {
                for n in 0..frames {
                    file.write_all(&(100 * n + 10 * h + w).to_le_bytes()).unwrap();
                }
            }
        }
        let bytes = 2 * u64::from(frames * height * width);
        let section = Section { start: 0, stored_bytes: bytes, bytes, packing: Packing::Plain };
        for batch_bytes in [1, 12, 30, 1 << 20] {
            let stream = SectionStream::new(file.try_clone().unwrap(), section).unwrap();
            let mut gathered = GatheredFrames::new(stream, 0, &[7, 3, 2], 2, batch_bytes);
            for n in [0, 6, 5, 1, 2, 3, 4, 0] {
                let expected: Vec<_> = [0, 1, 10, 11, 20, 21].map(|at| 100 * n as u16 + at).to_vec();
                gathered.load(n).unwrap();
                let found: Vec<_> =
                    gathered.bytes().as_chunks().0.iter().map(|&v| u16::from_le_bytes(v)).collect();
                assert_eq!(found, expected, "batches of {batch_bytes} bytes");
            }
        }
    }
}
