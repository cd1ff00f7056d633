//! Looks at some frames of a recording for what contradicts its description.

use isolux::inspect::{Claims, Inspector, Suspicion};
use isolux::{Channels, Frame, Plane, ShapeError};
use isolux_io::recording::{ChannelInfo, DistanceKind, DistanceUnit, ModulationFrequency};

use crate::error::PipelineError;
use crate::observer::Observer;
use crate::remark::Remark;
use crate::source::{FrameSource, SourceFacts};
use crate::standardize::{PROVENANCE, VALUES};

/// The stored channel of the distances.
const DISTANCE: &str = "distance";
/// Frames that are looked at, at most.
const MOST_FRAMES: usize = 16;
/// Frames that are looked at of any recording that has so many.
const FEWEST_FRAMES: usize = 4;
/// Pixels that are looked at where that allows more than the fewest frames.
const PIXELS: usize = 1 << 21;
/// Frames that follow each other: what stands still is seen in both.
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
    let stored = source.stored_channels();
    let mut inspector = Inspector::new(facts.shape, claims(&facts, &stored));
    // Codes are equal before a lens is applied to them, not after.
    let depths = facts.info.distance_kind == Some(DistanceKind::Z)
        && stored.iter().any(|channel| channel.name == DISTANCE);
    let (mut frame, mut distances) = (Frame::new(facts.shape), Plane::filled(facts.shape, f32::NAN));
    let wanted = Channels::AMPLITUDE
        | Channels::DISTANCE
        | Channels::INTEGRATION_TIME
        | Channels::TARGET
        | Channels::PHASE_SAMPLES;
    for index in frames {
        if observer.cancelled() {
            return Err(PipelineError::Interrupted);
        }
        if source.read(index, wanted & facts.available, &mut frame)? {
            let fits = |pushed: Result<(), ShapeError>| {
                pushed.map_err(|error| PipelineError::frame(&facts.name, index)(error.into()))
            };
            fits(inspector.push(&frame))?;
            if depths {
                source.read_plane(DISTANCE, index, &mut distances)?;
                fits(inspector.push_stored_distances(&frame, &distances))?;
            }
        }
    }
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
    let has = |name: &str| stored.iter().any(|channel| channel.name == name);
    let distance = stored.iter().find(|channel| channel.name == DISTANCE);
    let usual = distance.map(|channel| DistanceUnit::usual(channel.element));
    let info = &facts.info;
    let frequency = info.modulation_frequency_hz;
    // Frames carry the bins of a single frequency, or those of the finer one of two, or I and Q, which are no bins.
    let iq = has("phase_samples") && !facts.available.contains(Channels::PHASE_SAMPLES);
    let unwrapped = iq || matches!(frequency, Some(ModulationFrequency::Pair(_)));
    Claims {
        modulation_frequency_hz: frequency.map(|frequency| frequency.hz()),
        range_m: frequency.map(|frequency| frequency.unambiguous_range_m()),
        distance_unit_stated: info.distance_unit.is_some(),
        metres_per_unit: usual.map(|usual| info.distance_unit.unwrap_or(usual).metres()),
        phase_convention: info.phase_convention.unwrap_or_default(),
        distance_from_phases: has("phase_samples") && !has(DISTANCE),
        unwrapped_range_m: frequency.filter(|_| unwrapped).map(|frequency| frequency.unambiguous_range_m()),
        principal_point: facts
            .lens()
            .and_then(|lens| lens.principal_point())
            .map(|[row, column]| [column, row]),
        // With its input, the amplitude is that of the input.
        standardized: info.other.contains_key(PROVENANCE) && !has(VALUES),
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
