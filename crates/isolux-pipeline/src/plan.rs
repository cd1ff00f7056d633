//! Planning a chain for a recording.

use isolux::calibrate::NoiseSurvey;
use isolux::inspect::Suspicion;
use isolux::standardize::{SigmaStep, TimeStep};
use isolux::terms::NoiseModel;
use isolux::{Calibration, Channels, Choice, RecordingTraits, Standardizer};

mod light;
mod relative;

use crate::error::PipelineError;
use crate::frames;
use crate::inspect;
use crate::observer::{Observer, Work};
use crate::remark::Remark;
use crate::source::FrameSource;

/// Plans the chain for a recording. Some frames are looked at for what contradicts its description. Where the
/// standard deviation is required and the noise is unknown, the recording is read once to estimate it; where frames are to
/// be scaled relative to each other, to compare them; where the response needs the ambient light, some frames are read.
/// The observer receives what was found and the notes of the plan as remarks.
///
/// # Errors
/// [`PipelineError::Plan`] when the choice cannot be carried out, [`PipelineError::NoNoise`] and [`PipelineError::TooDark`], and those of reading.
pub fn plan(
    choice: &Choice,
    calibration: Option<&Calibration>,
    source: &mut dyn FrameSource,
    observer: &dyn Observer,
) -> Result<Standardizer, PipelineError> {
    plan_with(choice, calibration, source.facts().traits(), source, observer)
}

/// The same with `traits` in place of the recording's own, where the user knows better.
///
/// # Errors
/// Those of [`plan`].
pub fn plan_with(
    choice: &Choice,
    calibration: Option<&Calibration>,
    mut traits: RecordingTraits,
    source: &mut dyn FrameSource,
    observer: &dyn Observer,
) -> Result<Standardizer, PipelineError> {
    let suspicions = inspect::remark_on(source, observer)?;
    traits.already = Suspicion::already_corrected(&suspicions);
    source.facts().remark_on_lens(observer);
    let mut choice = *choice;
    let known = choice.noise.is_some() || calibration.is_some_and(|c| c.terms.noise.is_some());
    if choice.sigma == SigmaStep::Required && !known && traits.channels.contains(Channels::AMPLITUDE) {
        choice.noise = Some(estimate_noise(source, observer)?);
    }
    if traits.ambient_light.is_none()
        && let Some(response) = Standardizer::wants_ambient_light(&choice, calibration, &traits)
    {
        traits.ambient_light = light::estimate(response, source, observer)?;
    }
    if choice.time == Some(TimeStep::Relative) && traits.relative_exposure.is_none() {
        traits.relative_exposure = relative::compare(source, observer)?;
    }
    let standardizer = Standardizer::plan(&choice, calibration, traits)?;
    standardizer.notes().iter().for_each(|note| observer.remark(Remark::Plan(note.clone())));
    Ok(standardizer)
}

/// Estimates the noise of the amplitude from a recording.
fn estimate_noise(
    source: &mut dyn FrameSource,
    observer: &dyn Observer,
) -> Result<NoiseModel, PipelineError> {
    let wanted = Channels::AMPLITUDE | Channels::INTEGRATION_TIME | Channels::INTENSITY;
    let mut survey = NoiseSurvey::new();
    frames::for_each(source, wanted, Work::EstimatingNoise, observer, |_, frame| {
        survey.push(frame);
        Ok(())
    })?;
    let (found, recording) = (survey.finish(), source.facts().name);
    if found.spatial {
        observer.remark(Remark::NoiseFromNeighbours { recording: recording.clone() });
    }
    let noise = found.fit(Vec::new()).map(|noise| noise.model());
    noise.ok_or_else(|| match found.too_dark() {
        Some(signal_to_noise) => PipelineError::TooDark { recording, signal_to_noise },
        None => PipelineError::NoNoise { recording },
    })
}
