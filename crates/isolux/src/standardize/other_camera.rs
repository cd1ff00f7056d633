//! Is the calibration that of the recording's camera?

use super::planner::Planner;
use super::report::Note;
use crate::calibration::Calibration;

/// Modulation frequencies that differ by less than this share are the same.
const SAME_FREQUENCY: f64 = 1e-3;

/// Notes a camera or a modulation frequency that is not that of the calibration, as far as both are named.
pub(super) fn note(planner: &mut Planner<'_>) {
    let Some(calibration) = planner.calibration else { return };
    if let (Some(calibrated), Some(recorded)) = (&calibration.camera, &planner.traits.camera)
        && !is_same_name(calibrated, recorded)
    {
        let (calibrated, recorded) = (calibrated.clone(), recorded.clone());
        planner.notes.push(Note::OtherCamera { calibrated, recorded });
    }
    if let (Some(calibrated_hz), Some(recorded_hz)) =
        (frequency_hz(calibration), planner.traits.modulation_frequency_hz)
        && (calibrated_hz / recorded_hz - 1.0).abs() > SAME_FREQUENCY
    {
        planner.notes.push(Note::OtherFrequency { calibrated_hz, recorded_hz });
    }
}

/// Names differ in more than spaces and case.
fn is_same_name(one: &str, other: &str) -> bool {
    let plain = |name: &str| name.split_whitespace().collect::<String>().to_lowercase();
    plain(one) == plain(other)
}

/// The modulation frequency that the terms were fitted for.
fn frequency_hz(calibration: &Calibration) -> Option<f64> {
    let terms = &calibration.terms;
    let harmonic = terms.spline.as_ref().and_then(|spline| spline.law.harmonic);
    let ambient = terms.response.as_ref().and_then(|response| response.ambient.as_ref());
    let of_harmonic = harmonic.map(|harmonic| harmonic.modulation_frequency_hz);
    of_harmonic.or_else(|| ambient.and_then(|ambient| ambient.modulation_frequency_hz))
}
