//! The ambient light of simulated frames, estimated as for a recording.

use isolux::Calibration;
use isolux::calibrate::AmbientSurvey;
use isolux::standardize::AmbientLight;
use isolux_camera::Simulation;

use crate::error::ExperimentError;
use crate::measure::for_each;

/// The light that the noise of all frames tells; `None` where it is not known.
pub(super) fn estimate(
    calibration: &Calibration,
    simulation: &Simulation,
) -> Result<Option<AmbientLight>, ExperimentError> {
    let response = calibration.terms.response.as_ref().and_then(|response| response.ambient.as_ref());
    let Some(response) = response else { return Ok(None) };
    let mut survey = AmbientSurvey::new(response);
    let mut last = None;
    for_each(simulation, |index, simulated| {
        let pose = simulation.frames()[index].pose;
        if last.replace(pose) != Some(pose) {
            survey.part(index);
        }
        survey.push(&simulated.frame);
        Ok(())
    })?;
    Ok(survey.finish().ok())
}
