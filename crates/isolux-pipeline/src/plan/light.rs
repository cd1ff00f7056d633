//! The ambient light of a recording, estimated from some of its frames.

use isolux::calibrate::AmbientSurvey;
use isolux::standardize::AmbientLight;
use isolux::terms::response::AmbientResponse;
use isolux::{Channels, Frame};

use crate::error::PipelineError;
use crate::observer::{Observer, Progress, Work};
use crate::remark::Remark;
use crate::source::FrameSource;

/// Frames that are looked at. Their noise tells the light to a few percent: more would add nothing.
const FRAMES: usize = 32;
/// Frames that follow each other, so that differences between them show the noise.
const RUN: usize = 4;

/// The light that the noise of the amplitudes tells. `None` where it does not tell it, with a remark, and where the source
/// may be one that cannot be read twice.
pub(super) fn estimate(
    response: &AmbientResponse,
    source: &mut dyn FrameSource,
    observer: &dyn Observer,
) -> Result<Option<AmbientLight>, PipelineError> {
    let facts = source.facts();
    // A source of unknown length may be one that can be read only once.
    let Some(count) = facts.frame_count else { return Ok(None) };
    let runs = runs(count);
    let total = runs.iter().map(|first| RUN.min(count - first)).sum();
    let mut progress = Progress::start(observer, Work::EstimatingAmbientLight, Some(total));
    let mut survey = AmbientSurvey::new(response);
    let mut frame = Frame::new(facts.shape);
    for first in runs {
        survey.part(first);
        for index in first..(first + RUN).min(count) {
            progress.check()?;
            let wanted = Channels::AMPLITUDE | Channels::DISTANCE | Channels::INTEGRATION_TIME;
            if source.read(index, wanted, &mut frame)? {
                survey.push(&frame);
            }
            progress.step();
        }
    }
    progress.finish();
    match survey.finish() {
        Ok(light) => Ok(Some(light)),
        Err(cause) => {
            observer.remark(Remark::AmbientLightUnknown { recording: facts.name, cause });
            Ok(None)
        }
    }
}

/// First frames of the runs, spread evenly.
fn runs(count: usize) -> Vec<usize> {
    if count <= FRAMES {
        return (0..count).step_by(RUN).collect();
    }
    let runs = FRAMES / RUN;
    (0..runs).map(|run| (count - RUN) * run / (runs - 1)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_are_spread_over_the_whole_recording() {
        assert_eq!(runs(0), Vec::<usize>::new());
        assert_eq!(runs(3), [0]);
        assert_eq!(runs(10), [0, 4, 8]);
        let many = runs(1000);
        assert_eq!((many.len(), many[0], many[7]), (8, 0, 996));
    }
}
