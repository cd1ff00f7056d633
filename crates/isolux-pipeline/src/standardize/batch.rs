//! The frames that are worked on at once: as many as there are threads, as far as memory allows.

use isolux::standardize::{Prepared, StandardizeError, Workspace};
use isolux::{Frame, Standardized, Standardizer, Stream};
use isolux_io::recording::ChannelInfo;
use rayon::prelude::*;

use crate::error::PipelineError;
use crate::source::{FrameSource, SourceFacts};

/// Memory for the frames that are worked on at once, however many threads there are.
const BATCH_BYTES: usize = 128 << 20;

/// Frames are read one by one and in order; only the arithmetic is shared among threads.
pub(super) struct Batch<'a> {
    standardizer: &'a Standardizer,
    stream: Stream,
    kept: &'a [ChannelInfo],
    slots: Vec<Slot>,
}

/// A frame and its result.
pub(super) struct Slot {
    frame: Frame,
    prepared: Prepared,
    workspace: Workspace,
    pub(super) out: Standardized,
    /// The frame of each kept channel, verbatim.
    pub(super) kept: Vec<Vec<u8>>,
    pub(super) outcome: Result<(), StandardizeError>,
}

impl<'a> Batch<'a> {
    /// One frame at first, from which the memory of a frame is measured.
    pub(super) fn new(facts: &SourceFacts, standardizer: &'a Standardizer, kept: &'a [ChannelInfo]) -> Self {
        let slots = vec![Slot::new(facts.shape, kept.len())];
        Self { standardizer, stream: standardizer.stream(), kept, slots }
    }

    /// Makes room for a frame for each of `threads`, as far as [`BATCH_BYTES`] allow beside what else is `held`.
    pub(super) fn grow(&mut self, threads: usize, held: usize) {
        let Some(first) = self.slots.first() else { return };
        let (shape, room) = (first.frame.shape(), BATCH_BYTES.saturating_sub(held + self.stream.bytes()));
        let affordable = (room / first.bytes().max(1)).max(1);
        let kept = self.kept.len();
        self.slots.resize_with(threads.clamp(1, affordable), || Slot::new(shape, kept));
    }

    /// Reads the frames from `first` on; how many there were.
    pub(super) fn fill(
        &mut self,
        source: &mut dyn FrameSource,
        first: usize,
        name: &str,
    ) -> Result<usize, PipelineError> {
        for (offset, slot) in self.slots.iter_mut().enumerate() {
            let index = first + offset;
            if !source.read(index, self.standardizer.needed(), &mut slot.frame)? {
                return Ok(offset);
            }
            let taken = self.stream.prepare(&slot.frame, &mut slot.prepared);
            taken.map_err(|error| PipelineError::frame(name, index)(error.into()))?;
            // Now and not after the batch: going back to a frame may be impossible or slow.
            for (channel, bytes) in self.kept.iter().zip(&mut slot.kept) {
                source.read_raw(&channel.name, index, bytes)?;
            }
        }
        Ok(self.slots.len())
    }

    /// Standardizes the first `count` frames, and hands them out in their order.
    pub(super) fn standardize(&mut self, pool: &rayon::ThreadPool, count: usize) -> &mut [Slot] {
        let (standardizer, slots) = (self.standardizer, &mut self.slots[..count]);
        pool.install(|| slots.par_iter_mut().for_each(|slot| slot.apply(standardizer)));
        slots
    }
}

impl Slot {
    fn new(shape: isolux::Shape, kept: usize) -> Self {
        Self {
            frame: Frame::new(shape),
            prepared: Prepared::default(),
            workspace: Workspace::default(),
            out: Standardized::new(shape),
            kept: vec![Vec::new(); kept],
            outcome: Ok(()),
        }
    }

    fn apply(&mut self, standardizer: &Standardizer) {
        let Self { frame, prepared, workspace, out, .. } = self;
        self.outcome = standardizer.apply(frame, prepared, workspace, out);
    }

    fn bytes(&self) -> usize {
        let kept: usize = self.kept.iter().map(Vec::capacity).sum();
        self.frame.bytes() + self.prepared.bytes() + self.workspace.bytes() + self.out.bytes() + kept
    }
}
