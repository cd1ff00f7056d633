//! Diagnoses a recording: whether its amplitudes are already corrected, and what the vendor's scaling does.

use isolux::Channels;
use isolux::diagnose::{DiagnoseSettings, Diagnoser, Diagnosis, Finding};
use isolux::inspect::Suspicion;

use crate::error::PipelineError;
use crate::frames;
use crate::inspect::inspect;
use crate::observer::{Observer, Work};
use crate::source::FrameSource;

/// Looks at every frame of a recording. What contradicts its description comes first among the findings.
///
/// # Errors
/// [`PipelineError::Frame`] for frames whose planes do not fit together, and those of reading.
pub fn diagnose(source: &mut dyn FrameSource, observer: &dyn Observer) -> Result<Diagnosis, PipelineError> {
    let facts = source.facts();
    let computed = facts.amplitude_from_phase_samples;
    let settings = DiagnoseSettings {
        principal_point: facts
            .lens()
            .and_then(|lens| lens.principal_point())
            .map(|[row, column]| [column, row]),
        amplitude_from_phase_samples: computed,
    };
    let mut wanted = Channels::AMPLITUDE
        | Channels::DISTANCE
        | Channels::INTEGRATION_TIME
        | Channels::TARGET
        | Channels::VENDOR_AMPLITUDE;
    // An amplitude that was computed from the bins adds nothing to them.
    wanted.set(Channels::PHASE_SAMPLES, !computed);
    let suspicions = inspect(source, observer)?;
    let mut diagnoser = Diagnoser::new(facts.shape, settings);
    frames::for_each(source, wanted, Work::Diagnosing, observer, |index, frame| {
        let pushed = diagnoser.push(frame);
        pushed.map_err(|error| PipelineError::frame(&facts.name, index)(error.into()))
    })?;
    let mut diagnosis = diagnoser.finish();
    diagnosis.findings.splice(0..0, suspicions.into_iter().filter(is_quick_only).map(Finding::Suspicion));
    Ok(diagnosis)
}

/// True for what all frames do not tell better than a few.
fn is_quick_only(suspicion: &Suspicion) -> bool {
    !matches!(
        suspicion,
        Suspicion::ScaledByFrame(_)
            | Suspicion::ExposureChanged(_)
            | Suspicion::TimeCorrected { .. }
            | Suspicion::TimePartly { .. }
            | Suspicion::DistanceCorrected { .. }
            | Suspicion::AmplitudeClips { .. }
    )
}
