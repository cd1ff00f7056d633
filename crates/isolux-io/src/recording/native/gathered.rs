//! Frames of an array in Fortran order, where the frame index varies fastest and one frame lies scattered over
//! the whole file: one pass from front to back gathers as many neighbouring frames as memory allows.

use std::io;

use super::sequential::read_into;
use super::stream::SectionStream;

/// Bytes read at once, unless one pixel of all frames takes more.
const BLOCK_BYTES: usize = 1 << 20;

/// Frames gathered in batches.
pub(crate) struct GatheredFrames {
    stream: SectionStream,
    /// Byte of the first value.
    start: u64,
    frame_count: usize,
    /// Dimensions of one frame.
    frame_dims: Vec<usize>,
    element_bytes: usize,
    frames_per_batch: usize,
    first: Option<usize>,
    batch: Vec<u8>,
    block: Vec<u8>,
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
        }
    }

    /// The bytes of frame `index` in C order.
    pub(crate) fn frame(&mut self, index: usize) -> io::Result<&[u8]> {
        let first = index - index % self.frames_per_batch;
        if self.first != Some(first) {
            self.first = None;
            self.gather(first)?;
            self.first = Some(first);
        }
        let frame_bytes = self.values_per_frame() * self.element_bytes;
        let begin = (index - first) * frame_bytes;
        Ok(&self.batch[begin..begin + frame_bytes])
    }

    fn values_per_frame(&self) -> usize {
        self.frame_dims.iter().product()
    }

    fn gather(&mut self, first: usize) -> io::Result<()> {
        let frames = self.frames_per_batch.min(self.frame_count - first);
        let (size, values) = (self.element_bytes, self.values_per_frame());
        self.batch.clear();
        self.batch
            .try_reserve_exact(frames * values * size)
            .map_err(|error| io::Error::new(io::ErrorKind::OutOfMemory, error))?;
        self.batch.resize(frames * values * size, 0);

        let column_bytes = self.frame_count * size;
        let columns_per_block = (BLOCK_BYTES / column_bytes).clamp(1, values);
        let mut positions = FortranPositions::new(&self.frame_dims);
        self.stream.seek_to(self.start)?;
        for block_first in (0..values).step_by(columns_per_block) {
            let columns = columns_per_block.min(values - block_first);
            read_into(&mut self.stream, columns * column_bytes, &mut self.block)?;
            for column in self.block.chunks_exact(column_bytes) {
                let wanted = &column[first * size..(first + frames) * size];
                scatter(wanted, size, values * size, &mut self.batch[positions.next_position() * size..]);
            }
        }
        Ok(())
    }
}

/// Copies value k of `column` to byte `k * stride` of `out`.
fn scatter(column: &[u8], size: usize, stride: usize, out: &mut [u8]) {
    match size {
        1 => scatter_sized::<1>(column, stride, out),
        2 => scatter_sized::<2>(column, stride, out),
        4 => scatter_sized::<4>(column, stride, out),
        _ => scatter_sized::<8>(column, stride, out),
    }
}

fn scatter_sized<const SIZE: usize>(column: &[u8], stride: usize, out: &mut [u8]) {
    for (k, value) in column.as_chunks::<SIZE>().0.iter().enumerate() {
        out[k * stride..k * stride + SIZE].copy_from_slice(value);
    }
}

/// Walks through a frame in Fortran order, first index fastest, and tells each value's position in C order.
struct FortranPositions {
    /// (length, distance in C order) of each dimension.
    dims: Vec<(usize, usize)>,
    index: Vec<usize>,
    position: usize,
}

impl FortranPositions {
    fn new(dims: &[usize]) -> Self {
        let mut distance = 1;
        let mut dims: Vec<_> = dims
            .iter()
            .rev()
            .map(|&dim| {
                let row = (dim, distance);
                distance *= dim;
                row
            })
            .collect();
        dims.reverse();
        Self { index: vec![0; dims.len()], dims, position: 0 }
    }

    fn next_position(&mut self) -> usize {
        let position = self.position;
        for (index, &(dim, distance)) in self.index.iter_mut().zip(&self.dims) {
            *index += 1;
            self.position += distance;
            if *index < dim {
                break;
            }
            *index = 0;
            self.position -= dim * distance;
        }
        position
    }
}

#[cfg(test)]
mod tests {
    use std::io::Write;

    use super::super::stream::{Packing, Section};
    use super::*;

    #[test]
    fn a_walk_in_fortran_order_meets_every_position_once() {
        let mut positions = FortranPositions::new(&[2, 3]);
        let walk: Vec<_> = (0..6).map(|_| positions.next_position()).collect();
        assert_eq!(walk, [0, 3, 1, 4, 2, 5]);
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
                let found: Vec<_> =
                    gathered.frame(n).unwrap().as_chunks().0.iter().map(|&v| u16::from_le_bytes(v)).collect();
                assert_eq!(found, expected, "batches of {batch_bytes} bytes");
            }
        }
    }
}
