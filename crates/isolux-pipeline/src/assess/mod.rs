//! Evaluates the frames of a recording before and after standardization, also by the textbook's and the paper's
//! chain.

mod assessment;
mod evaluation;
mod rivals;
mod samples;

use isolux::evaluate::{Comparison, nearest_reference};
use isolux::still_scene::MotionWatch;
use isolux::{Channels, Frame, IntegrationTime, Standardizer};

use self::evaluation::Evaluation;
use self::rivals::Rivals;
use crate::error::PipelineError;
use crate::frames;
use crate::observer::{Observer, Work};
use crate::remark::Remark;
use crate::source::FrameSource;

pub use self::assessment::{AssessOptions, Assessment, MeanAtTime, Pixels};
pub use self::rivals::Standing;
pub use self::samples::{SampleFrame, first_frames_at, sample_frames};

/// Evaluates the raw and the standardized amplitude of the same frames. Two passes: one over the integration
/// times to find the reference exposure, one over the frames.
///
/// # Errors
/// [`PipelineError::Frame`] for frames that the chain cannot take, those of reading, and
/// [`PipelineError::Interrupted`] once the observer has cancelled.
pub fn assess(
    source: &mut dyn FrameSource,
    standardizer: &Standardizer,
    options: &AssessOptions<'_>,
    observer: &dyn Observer,
) -> Result<Assessment, PipelineError> {
    let facts = source.facts();
    let rivals = match options.rivals {
        true => Rivals::new(standardizer, options.calibration, facts.traits(), facts.shape),
        false => Rivals::none(),
    };
    let mut evaluation = Evaluation::new(facts.shape, standardizer, options.pixels, rivals);
    let wanted = standardizer.needed()
        | evaluation.rivals.needed()
        | Channels::DISTANCE
        | Channels::INTEGRATION_TIME
        | Channels::TARGET;
    let times = samples::frame_times(source, observer)?;
    let calibrated_us = options.calibration.and_then(|c| c.reference.integration_time_us);
    let reference_us = calibrated_us.unwrap_or(isolux::calibration::REFERENCE_TIME_US);
    let reference = nearest_reference(times.iter().copied(), reference_us);
    if let Some(index) = reference {
        let mut frame = Frame::new(facts.shape);
        frames::read_alone(source, index, wanted, &mut evaluation.stream, &mut frame)?;
        let taken = evaluation.take(&frame, |evaluator, frame| evaluator.set_reference(frame));
        taken.map_err(|error| PipelineError::frame(&facts.name, index)(error.into()))?;
        evaluation.stream.continue_at(0);
    }
    let (mut motion, mut last_us) = (MotionWatch::default(), None);
    frames::for_each(source, wanted, Work::Evaluating, observer, |index, frame| {
        if let IntegrationTime::PerFrame(time_us) = frame.integration_time_us
            && last_us.replace(time_us) != Some(time_us)
        {
            motion.push(time_us, frame);
        }
        let pushed = evaluation.push(frame);
        pushed.map_err(|error| PipelineError::frame(&facts.name, index)(error.into()))
    })?;
    if let Some(movement) = motion.verdict() {
        let (share, integration_time_us) = (movement.share, movement.integration_time_us);
        observer.remark(Remark::SceneMoved { share, integration_time_us });
    }
    Ok(Assessment {
        frames: times.len(),
        comparison: Comparison::new(&evaluation.before, &evaluation.after),
        rivals: evaluation.rivals.standings(&evaluation.before),
        means: evaluation.means(),
        shown_frames: shown_frames(&times, reference),
    })
}

fn shown_frames(times: &[Option<f64>], reference: Option<usize>) -> Vec<usize> {
    let extreme = |wanted: fn(f64, f64) -> f64| times.iter().flatten().copied().reduce(wanted);
    let index_of = |time: Option<f64>| times.iter().position(|found| time.is_some() && *found == time);
    let mut shown = match reference {
        Some(reference) => vec![index_of(extreme(f64::min)), Some(reference), index_of(extreme(f64::max))],
        None => vec![Some(0), Some(times.len() / 2), times.len().checked_sub(1)],
    };
    shown.sort_unstable();
    shown.dedup();
    shown.into_iter().flatten().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_shown_frames_span_the_times() {
        let times = [400.0, 200.0, 800.0, 200.0].map(Some);
        assert_eq!(shown_frames(&times, Some(0)), [0, 1, 2]);
        assert_eq!(shown_frames(&times, Some(1)), [1, 2]);
        // Without times, the first, the middle and the last frame.
        assert_eq!(shown_frames(&[None; 5], None), [0, 2, 4]);
        assert_eq!(shown_frames(&[None], None), [0]);
    }
}
