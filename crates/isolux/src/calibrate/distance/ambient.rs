//! The response by amplitude and distance, fitted to distance sweeps, and the decays that it makes linear.

use super::ReferenceDecays;
use crate::calibrate::CalibrateSettings;
use crate::calibration::Calibration;
use crate::terms::Response;
use crate::terms::cubic::{Decay, DecayPoint};
use crate::terms::response::{AmbientError, AmbientResponse, TargetSample};

/// Fits the tier to the amplitudes of the sweeps as they were delivered.
///
/// # Errors
/// [`AmbientError`] when the sweeps do not determine it.
pub(super) fn fit(
    settings: &CalibrateSettings,
    sweeps: &[ReferenceDecays],
) -> Result<AmbientResponse, AmbientError> {
    let samples: Vec<Vec<TargetSample>> = sweeps.iter().map(|sweep| sweep.samples.clone()).collect();
    let sources = sweeps.iter().map(|sweep| sweep.source.clone()).collect();
    let (reference_m, frequency_hz) = (settings.reference.distance_m, settings.modulation_frequency_hz);
    AmbientResponse::fit(&samples, reference_m, frequency_hz, sources)
}

/// The decays in linear amplitudes. Positions that are too near to the largest amplitude are left out, and so are decays
/// at unknown times.
pub(super) fn linear(response: &AmbientResponse, decays: &[Decay]) -> Vec<Decay> {
    let linear = |point: &DecayPoint| {
        let amplitude_dn = response.linear_of_sweep_dn(point.amplitude_dn, point.distance_m)?;
        Some(DecayPoint { amplitude_dn, ..*point })
    };
    let decay = |decay: &Decay| {
        decay.integration_time_us?;
        let points: Vec<DecayPoint> = decay.points.iter().filter_map(linear).collect();
        (!points.is_empty()).then_some(Decay { points, ..*decay })
    };
    decays.iter().filter_map(decay).collect()
}

/// Puts the tier beside those that exposure sweeps determine.
pub(super) fn keep(settings: &CalibrateSettings, fitted: AmbientResponse, calibration: &mut Calibration) {
    // Linear amplitudes can be brought to any time, also without a table.
    calibration.reference.integration_time_us.get_or_insert(settings.reference_time_us());
    calibration.terms.response.get_or_insert_with(Response::empty).ambient = Some(fitted);
}
