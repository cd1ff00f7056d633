//! Looks at some frames of a recording for what contradicts its description.

use isolux::inspect::{Claims, Inspector, Suspicion};
use isolux::{Channels, Frame};
use isolux_io::RecordingInfo;
use isolux_io::recording::{ChannelInfo, ModulationFrequency};

use crate::error::PipelineError;
use crate::observer::{Observer, Progress, Work};
use crate::remark::Remark;
use crate::source::{FrameSource, SourceFacts};

/// Frames that are looked at, at most.
const MOST_FRAMES: usize = 16;
/// Frames that are looked at of any recording that has so many.
const FEWEST_FRAMES: usize = 4;
/// Pixels that are looked at where that allows more than the fewest frames.
const PIXELS: usize = 1 << 21;
/// Frames that follow each other, so that differences between them show the noise.
const RUN: usize = 2;

/// Looks at the first and some later frames of a recording. Nothing is read of a source of unknown length, which may be
/// one that can be read only once.
///
/// # Errors
/// [`PipelineError::Frame`] for frames whose planes do not fit together, and those of reading;
/// [`PipelineError::Interrupted`] once the observer has cancelled.
pub fn inspect(
    source: &mut dyn FrameSource,
    observer: &dyn Observer,
) -> Result<Vec<Suspicion>, PipelineError> {
    let facts = source.facts();
    let Some(count) = facts.frame_count else { return Ok(Vec::new()) };
    let frames = frames(count, facts.shape.pixels());
    let mut progress = Progress::start(observer, Work::Inspecting, Some(frames.len()));
    let mut inspector = Inspector::new(facts.shape, claims(&facts, &source.stored_channels()));
    let mut frame = Frame::new(facts.shape);
    let wanted =
        Channels::AMPLITUDE | Channels::DISTANCE | Channels::INTEGRATION_TIME | Channels::PHASE_SAMPLES;
    for index in frames {
        progress.check()?;
        if source.read(index, wanted & facts.available, &mut frame)? {
            let pushed = inspector.push(index, &frame);
            pushed.map_err(|error| PipelineError::frame(&facts.name, index)(error.into()))?;
        }
        progress.step();
    }
    progress.finish();
    Ok(inspector.finish())
}

/// The same, with each suspicion as a remark to the observer.
pub(crate) fn remark_on(
    source: &mut dyn FrameSource,
    observer: &dyn Observer,
) -> Result<Vec<Suspicion>, PipelineError> {
    let (suspicions, recording) = (inspect(source, observer)?, source.facts().name);
    for suspicion in &suspicions {
        let (recording, suspicion) = (recording.clone(), suspicion.clone());
        observer.remark(Remark::Suspicion { recording, suspicion });
    }
    Ok(suspicions)
}

fn claims(facts: &SourceFacts, stored: &[ChannelInfo]) -> Claims {
    let RecordingInfo { modulation_frequency_hz, distance_unit, phase_convention, .. } = &facts.info;
    let is_stored = |name| stored.iter().any(|channel| channel.name == name);
    // Frames carry the bins of a single frequency, or those of the finer one of two, or I and Q, which are no bins.
    let iq = is_stored("phase_samples") && !facts.available.contains(Channels::PHASE_SAMPLES);
    let unwrapped = iq || matches!(modulation_frequency_hz, Some(ModulationFrequency::Pair(_)));
    let integer = |name| stored.iter().any(|channel| channel.name == name && channel.element.is_integer());
    Claims {
        modulation_frequency_hz: modulation_frequency_hz.map(|frequency| frequency.hz()),
        amplitude_is_integer: integer("amplitude"),
        distance_is_integer: integer("distance"),
        distance_unit_stated: distance_unit.is_some(),
        amplitude_from_phase_samples: facts.amplitude_from_phase_samples,
        phase_convention: phase_convention.unwrap_or_default(),
        distance_from_phases: is_stored("phase_samples") && !is_stored("distance"),
        unwrapped_range_m: modulation_frequency_hz.filter(|_| unwrapped).map(|f| f.unambiguous_range_m()),
        ..Claims::default()
    }
}

/// The frames to be looked at: runs from the first to the last, ascending.
fn frames(count: usize, pixels: usize) -> Vec<usize> {
    let wanted = (PIXELS / pixels.max(1)).clamp(FEWEST_FRAMES, MOST_FRAMES);
    if count <= wanted {
        return (0..count).collect();
    }
    let runs = wanted / RUN;
    let starts = (0..runs).map(|run| (count - RUN) * run / (runs - 1));
    starts.flat_map(|start| start..start + RUN).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_frames_of_large_images_and_all_of_short_recordings_are_looked_at() {
        assert_eq!(frames(0, 10), Vec::<usize>::new());
        assert_eq!(frames(3, 10), [0, 1, 2]);
        assert_eq!(frames(200, 1 << 20), [0, 1, 198, 199]);
        let small = frames(1000, 176 * 144);
        assert_eq!((small.len(), small[0], small[15]), (16, 0, 999));
        assert!(small.is_sorted());
    }
}
