//! Which frames of a recording make one bracket, and merging them.

use isolux::standardize::{BracketMerge, FrameSummary};
use isolux::{Channels, IntegrationTime, PixelFlags, Shape, Standardized, Standardizer};
use isolux_io::Recording;

use crate::failure::{Failure, Outcome};
use crate::frames;

/// Consecutive brackets, by the number of frames of each.
#[derive(Clone, Debug)]
pub(crate) struct Brackets {
    pub(crate) lengths: Vec<usize>,
}

impl Brackets {
    /// Brackets of `length` frames each, the last one perhaps of fewer; without a length, one ends where an
    /// integration time recurs.
    pub(crate) fn plan(recording: &mut dyn Recording, length: Option<u16>) -> Outcome<Self> {
        let frame_count = recording.metadata().frame_count;
        if let Some(length) = length {
            let length = usize::from(length);
            let starts = (0..frame_count).step_by(length);
            return Ok(Self { lengths: starts.map(|start| length.min(frame_count - start)).collect() });
        }
        let path = recording.metadata().path.display().to_string();
        let (mut lengths, mut times_us) = (Vec::new(), Vec::new());
        frames::for_each(recording, Channels::INTEGRATION_TIME, "reading times", |index, frame| {
            let IntegrationTime::PerFrame(time_us) = frame.integration_time_us else {
                return Err(Failure::usage(format!(
                    "`{path}`, frame {index}: found no single integration time, one expected to tell where a bracket \
                     ends: say how many frames it has, --merge-bracket=N"
                )));
            };
            let same = |known: &f64| (known / time_us).max(time_us / known) < IntegrationTime::SAME_RATIO;
            if times_us.iter().any(same) {
                lengths.push(times_us.len());
                times_us.clear();
            }
            times_us.push(time_us);
            Ok(())
        })?;
        lengths.push(times_us.len());
        if lengths.iter().all(|length| *length < 2) {
            return Err(Failure::usage(format!(
                "`{path}`: every integration time is followed by itself, another one expected in a bracket: say how many \
                 frames a bracket has, --merge-bracket=N"
            )));
        }
        Ok(Self { lengths })
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
pub(super) struct Merging {
    merge: BracketMerge,
    lengths: std::vec::IntoIter<usize>,
    left: usize,
    /// Pixels that every frame so far refuses for its time, at most.
    refused: usize,
    pub(super) out: Standardized,
}

impl Merging {
    /// The chain for the frames, and what merges them.
    pub(super) fn start(standardizer: &Standardizer, brackets: &Brackets) -> Outcome<(Standardizer, Self)> {
        let (frames, merge) = standardizer.bracket().map_err(|error| {
            Failure::usage(format!(
                "--merge-bracket: {error}: give the noise (--read-noise-dn, --shot-noise-dn2-per-dn), a calibration that \
                 holds it, or --sigma on to estimate it from the recording"
            ))
        })?;
        let mut lengths = brackets.lengths.clone().into_iter();
        let left = lengths.next().unwrap_or(0);
        Ok((
            frames,
            Self { merge, lengths, left, refused: usize::MAX, out: Standardized::new(Shape::new(0, 0)) },
        ))
    }

    /// Takes the next frame; the merged one is in `out` when this was the last of its bracket.
    pub(super) fn push(
        &mut self,
        frame: &Standardized,
        summary: &FrameSummary,
    ) -> Result<Option<FrameSummary>, Failure> {
        self.refused = self.refused.min(summary.time_refused);
        self.merge.push(frame).map_err(Failure::data)?;
        self.left = self.left.saturating_sub(1);
        if self.left > 0 {
            return Ok(None);
        }
        self.left = self.lengths.next().unwrap_or(0);
        let merged = self.merge.finish(&mut self.out);
        let extrapolated = |flags: &&PixelFlags| {
            flags.contains(PixelFlags::TIME_OUT_OF_RANGE) && !flags.contains(PixelFlags::INVALID)
        };
        Ok(Some(FrameSummary {
            time_refused: std::mem::replace(&mut self.refused, usize::MAX),
            time_extrapolated: self.out.flags.values().iter().filter(extrapolated).count(),
            ..merged
        }))
    }
}
