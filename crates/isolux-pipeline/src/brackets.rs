//! Finds the brackets of a recording and merges their frames.

use isolux::standardize::BracketMerge;
use isolux::{Channels, IntegrationTime, PixelFlags, Shape, Standardized, Standardizer};

use crate::error::{FrameError, PipelineError};
use crate::frames;
use crate::observer::{Observer, Work};
use crate::source::FrameSource;

/// Consecutive brackets: frames of a still scene at several integration times, which are merged into one.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Brackets {
    lengths: Vec<usize>,
}

impl Brackets {
    /// Brackets of `length` frames each, the last one perhaps of fewer. Without a length, a bracket ends where an
    /// integration time recurs.
    ///
    /// # Errors
    /// [`PipelineError::BracketTime`] and [`PipelineError::NoBrackets`] where the times do not show where brackets
    /// end, [`PipelineError::LengthUnknown`] for a given length and an unknown number of frames, and those of
    /// reading.
    pub fn plan(
        source: &mut dyn FrameSource,
        length: Option<u16>,
        observer: &dyn Observer,
    ) -> Result<Self, PipelineError> {
        let facts = source.facts();
        let Some(length) = length else { return Self::by_times(source, &facts.name, observer) };
        let frame_count = facts.frame_count.ok_or(PipelineError::LengthUnknown { recording: facts.name })?;
        let length = usize::from(length).max(1);
        let starts = (0..frame_count).step_by(length);
        Ok(Self { lengths: starts.map(|start| length.min(frame_count - start)).collect() })
    }

    fn by_times(
        source: &mut dyn FrameSource,
        name: &str,
        observer: &dyn Observer,
    ) -> Result<Self, PipelineError> {
        let (mut lengths, mut times_us) = (Vec::new(), Vec::new());
        frames::for_each(
            source,
            Channels::INTEGRATION_TIME,
            Work::ReadingTimes,
            observer,
            |index, frame| {
                let IntegrationTime::PerFrame(time_us) = frame.integration_time_us else {
                    return Err(PipelineError::BracketTime { recording: name.to_owned(), frame: index });
                };
                let same = |known: &f64| (known / time_us).max(time_us / known) < IntegrationTime::SAME_RATIO;
                if times_us.iter().any(same) {
                    lengths.push(times_us.len());
                    times_us.clear();
                }
                times_us.push(time_us);
                Ok(())
            },
        )?;
        lengths.push(times_us.len());
        if lengths.iter().all(|length| *length < 2) {
            return Err(PipelineError::NoBrackets { recording: name.to_owned() });
        }
        Ok(Self { lengths })
    }

    /// Number of brackets.
    #[must_use]
    pub fn count(&self) -> usize {
        self.lengths.len()
    }

    /// In words, for the record of the steps.
    pub(crate) fn describe(&self) -> String {
        let (shortest, longest) =
            (self.lengths.iter().min().unwrap_or(&0), self.lengths.iter().max().unwrap_or(&0));
        let frames =
            if shortest == longest { format!("{longest}") } else { format!("{shortest} to {longest}") };
        format!("{frames} frames into one, weighted by 1/sigma², saturated pixels left out")
    }
}

/// The bracket that is being merged.
#[derive(Debug)]
pub(crate) struct Merging {
    merge: BracketMerge,
    lengths: std::vec::IntoIter<usize>,
    left: usize,
    /// Upper limit of the number of pixels that every frame so far has refused because of its time.
    refused: usize,
    out: Standardized,
}

impl Merging {
    /// The chain for the frames, and what merges them.
    pub(crate) fn start(
        standardizer: &Standardizer,
        brackets: &Brackets,
    ) -> Result<(Standardizer, Self), PipelineError> {
        let (frames, merge) = standardizer.bracket().map_err(|cause| PipelineError::Merge { cause })?;
        let mut lengths = brackets.lengths.clone().into_iter();
        let left = lengths.next().unwrap_or(0);
        let out = Standardized::new(Shape::new(0, 0));
        Ok((frames, Self { merge, lengths, left, refused: usize::MAX, out }))
    }

    /// Bytes that it holds, known after the first frame.
    pub(crate) fn bytes(&self) -> usize {
        self.merge.bytes() + self.out.bytes()
    }

    /// Takes the next frame. Returns the merged frame when this was the last of its bracket.
    pub(crate) fn push(&mut self, frame: &Standardized) -> Result<Option<&Standardized>, FrameError> {
        self.refused = self.refused.min(frame.summary.time_refused);
        self.merge.push(frame)?;
        self.left = self.left.saturating_sub(1);
        if self.left > 0 {
            return Ok(None);
        }
        self.left = self.lengths.next().unwrap_or(0);
        self.merge.finish(&mut self.out);
        let extrapolated = |flags: &&PixelFlags| {
            flags.contains(PixelFlags::TIME_OUT_OF_RANGE) && !flags.contains(PixelFlags::INVALID)
        };
        self.out.summary.time_refused = std::mem::replace(&mut self.refused, usize::MAX);
        self.out.summary.time_extrapolated = self.out.flags.values().iter().filter(extrapolated).count();
        Ok(Some(&self.out))
    }
}

#[cfg(test)]
mod tests {
    use isolux::Frame;

    use super::*;
    use crate::observer::Unobserved;
    use crate::source::{FramesInMemory, SourceFacts};

    fn plan(times_us: &[f64], length: Option<u16>) -> Result<Brackets, PipelineError> {
        let shape = Shape::new(1, 1);
        let frame = |&time_us: &f64| {
            let mut frame = Frame::new(shape);
            frame.integration_time_us = IntegrationTime::PerFrame(time_us);
            frame
        };
        let frames: Vec<Frame> = times_us.iter().map(frame).collect();
        let facts = SourceFacts::new("still", shape, Channels::INTEGRATION_TIME);
        Brackets::plan(&mut FramesInMemory::new(facts, &frames), length, &Unobserved)
    }

    #[test]
    fn a_bracket_ends_where_a_time_recurs_or_after_so_many_frames() {
        let times_us = [200.0, 400.0, 200.5, 400.0, 800.0];
        assert_eq!(plan(&times_us, None).unwrap().lengths, [2, 3]);
        let fixed = plan(&times_us, Some(2)).unwrap();
        assert_eq!(fixed.lengths, [2, 2, 1]);
        assert_eq!(
            fixed.describe(),
            "1 to 2 frames into one, weighted by 1/sigma², saturated pixels left out"
        );
        assert!(matches!(plan(&[200.0, 200.0], None), Err(PipelineError::NoBrackets { .. })));
    }
}
