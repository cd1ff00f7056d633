//! What the frames of a recording have relative to each other.

use isolux::Channels;
use isolux::standardize::{ExposureSurvey, RelativeExposure};

use crate::error::PipelineError;
use crate::frames;
use crate::observer::{Observer, Work};
use crate::source::FrameSource;

/// Compares all frames of a recording. `None` where too little stands still, and where the source may be one that
/// cannot be read twice.
pub(super) fn compare(
    source: &mut dyn FrameSource,
    observer: &dyn Observer,
) -> Result<Option<RelativeExposure>, PipelineError> {
    let facts = source.facts();
    // A source of unknown length may be one that can be read only once.
    if facts.frame_count.is_none() {
        return Ok(None);
    }
    let wanted = Channels::AMPLITUDE | Channels::DISTANCE;
    let mut survey = ExposureSurvey::new(facts.shape);
    frames::for_each(source, wanted & facts.available, Work::ComparingFrames, observer, |_, frame| {
        survey.push(frame);
        Ok(())
    })?;
    Ok(survey.finish())
}
