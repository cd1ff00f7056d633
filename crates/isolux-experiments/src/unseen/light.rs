//! The ambient light of simulated frames, estimated as for a recording.

use std::ops::Range;

use isolux::Calibration;
use isolux::calibrate::AmbientSurvey;
use isolux::standardize::AmbientLight;
use isolux_camera::{SimulatedFrame, Simulation};

use crate::error::ExperimentError;

/// The light that the noise of these runs of frames tells; `None` where it is not known.
pub(super) fn estimate(
    calibration: &Calibration,
    simulation: &Simulation,
    runs: impl IntoIterator<Item = Range<usize>>,
) -> Result<Option<AmbientLight>, ExperimentError> {
    let response = calibration.terms.response.as_ref().and_then(|response| response.ambient.as_ref());
    let Some(response) = response else { return Ok(None) };
    let mut survey = AmbientSurvey::new(response);
    let mut out = SimulatedFrame::new(simulation.shape());
    for run in runs {
        survey.part(run.start);
        for index in run {
            simulation.render_frame(index, &mut out)?;
            survey.push(&out.frame);
        }
    }
    Ok(survey.finish().ok())
}

/// The frames of each pose.
pub(super) fn poses(simulation: &Simulation) -> Vec<Range<usize>> {
    let mut end = 0;
    let run = |run: &[isolux_camera::PlannedFrame]| {
        let start = end;
        end += run.len();
        start..end
    };
    simulation.frames().chunk_by(|a, b| a.pose == b.pose).map(run).collect()
}
