//! The frames that are worked on at once: as many as there are threads, as far as memory allows.

use isolux::standardize::{BracketMerge, FrameSummary, StandardizeError};
use isolux::{Frame, Standardized, Standardizer};
use isolux_io::recording::ChannelInfo;
use rayon::prelude::*;

use crate::chain::{self, Chain, Smoothed};
use crate::error::PipelineError;
use crate::source::{FrameSource, SourceFacts};

/// Memory for the frames that are worked on at once, however many threads there are.
const BATCH_BYTES: usize = 128 << 20;
/// Amplitude, distance, integration times and flags of a frame; result, flags and the specular rule's scratch; up
/// to four planes of the denoising rules; intensity and raw bins, linear amplitude and distance of the response; four of
/// the angles.
const SLOT_BYTES_PER_PIXEL: usize = 4 + 4 + 4 + 2 + 4 + 2 + 4 + 4 * 4 + 5 * 4 + 2 * 4 + 4 * 4;
/// Intensity, result, and what denoising leaves of the distance's noise.
const SIGMA_BYTES_PER_PIXEL: usize = 4 + 4 + 4;

/// Reading goes frame by frame and in order; only the arithmetic is shared out.
pub(super) struct Batch<'a> {
    standardizer: &'a Standardizer,
    chain: Chain<'a>,
    kept: &'a [ChannelInfo],
    slots: Vec<Slot>,
}

/// A frame and its result.
pub(super) struct Slot {
    frame: Frame,
    smoothed: Smoothed,
    pub(super) out: Standardized,
    /// The frame of each kept channel, verbatim.
    pub(super) kept: Vec<Vec<u8>>,
    pub(super) outcome: Result<FrameSummary, StandardizeError>,
}

impl<'a> Batch<'a> {
    pub(super) fn new(
        facts: &SourceFacts,
        standardizer: &'a Standardizer,
        kept: &'a [ChannelInfo],
        merging: bool,
        threads: usize,
    ) -> Self {
        let chain = Chain::new(standardizer);
        let count = threads.min(affordable_slots(facts, kept, &chain, merging));
        let slot = |_| Slot {
            frame: Frame::new(facts.shape),
            smoothed: chain.smoothed(),
            out: Standardized::new(facts.shape),
            kept: vec![Vec::new(); kept.len()],
            outcome: Ok(FrameSummary::default()),
        };
        let slots = (0..count).map(slot).collect();
        Self { standardizer, chain, kept, slots }
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
            let taken = self.chain.take(&slot.frame, &mut slot.smoothed);
            taken.map_err(|error| PipelineError::frame(name, index)(error.into()))?;
            // Now, not after the batch: a deflated channel that goes back a frame is decoded anew from its start.
            for (channel, bytes) in self.kept.iter().zip(&mut slot.kept) {
                source.read_raw(&channel.name, index, bytes)?;
            }
        }
        Ok(self.slots.len())
    }

    /// Standardizes the first `count` frames, and hands them out in their order.
    pub(super) fn standardize(&mut self, pool: &rayon::ThreadPool, count: usize) -> &mut [Slot] {
        let (standardizer, slots) = (self.standardizer, &mut self.slots[..count]);
        pool.install(|| {
            slots.par_iter_mut().for_each(|slot| {
                slot.outcome = chain::apply(standardizer, &slot.frame, &slot.smoothed, &mut slot.out);
            });
        });
        slots
    }
}

/// Frames that fit into [`BATCH_BYTES`], at least one.
fn affordable_slots(facts: &SourceFacts, kept: &[ChannelInfo], chain: &Chain<'_>, merging: bool) -> usize {
    let kept_bytes: usize = kept.iter().map(ChannelInfo::frame_bytes).sum();
    let (smoothed, history) = chain.bytes_per_pixel();
    let sigma = if chain.predicts_sigma() { SIGMA_BYTES_PER_PIXEL } else { 0 };
    let slot_bytes = facts.shape.pixels() * (SLOT_BYTES_PER_PIXEL + sigma + smoothed) + kept_bytes;
    let merge = if merging { BracketMerge::BYTES_PER_PIXEL } else { 0 };
    (BATCH_BYTES.saturating_sub(facts.shape.pixels() * (history + merge)) / slot_bytes.max(1)).max(1)
}
