//! Fits the tiers of the response to exposure sweeps.

use super::{ExposureCurve, MissingTier};
use crate::calibrate::CalibrateSettings;
use crate::terms::response::{
    AmplitudeResponse, AmplitudeStack, IntensityResponse, PhaseSampleResponse, PixelResponse, PixelSeries,
    Response, ResponseError, ScalarResponse,
};
use crate::terms::{Lut, Source};

/// The recordings, as the calibration names them.
pub(super) fn sources(curves: &[ExposureCurve]) -> Vec<Source> {
    curves.iter().map(|curve| curve.source.clone()).collect()
}

/// Fits every tier that the sweeps determine, and lists those that they do not. The mean curve is that of the
/// table, in which several sweeps are already merged. Without a scalar tier, there is no response.
pub(in crate::calibrate) fn fit_response(
    settings: &CalibrateSettings,
    curves: &[ExposureCurve],
    lut: &Lut,
) -> (Option<Response>, Vec<MissingTier>) {
    let mut missing = Vec::new();
    let fitted_on = || sources(curves);
    let scalar = keep("scalar", ScalarResponse::fit(&lut.curve(), fitted_on()), &mut missing);
    let floors = curves.iter().filter_map(|curve| curve.noise_floor);
    let least_dn = floors.map(|floor| floor.low_signal_below_dn).fold(0.0, f64::max);
    let stacks: Vec<&AmplitudeStack> = curves.iter().map(|curve| &curve.evidence.stack).collect();
    let amplitude = keep("amplitude", AmplitudeResponse::fit(&stacks, least_dn, fitted_on()), &mut missing);
    // A map is valid for one scene only, so that several sweeps have no common map.
    let pixel = match stacks.as_slice() {
        [stack] => keep("pixel", PixelResponse::fit(stack, least_dn, fitted_on()), &mut missing),
        _ => None,
    };
    let pixels: Vec<PixelSeries> = curves.iter().flat_map(|c| c.evidence.pixels.iter().cloned()).collect();
    let delivered = |value: fn(&PixelSeries) -> bool| pixels.iter().any(value);
    let intensity = delivered(|series| series.iter().any(|m| m.intensity_dn.is_finite()))
        .then(|| keep("intensity", IntensityResponse::fit(&pixels, fitted_on()), &mut missing))
        .flatten();
    let phase_samples = delivered(|series| series.iter().any(|m| m.phase_samples_dn[0].is_finite()))
        .then(|| {
            let frequency_hz = settings.modulation_frequency_hz;
            let fitted = PhaseSampleResponse::fit(&pixels, frequency_hz, fitted_on());
            keep("phase_samples", fitted, &mut missing)
        })
        .flatten();
    let response = Response {
        version: Response::VERSION,
        scalar,
        amplitude,
        pixel,
        ambient: None,
        intensity,
        phase_samples,
        warnings: missing.iter().map(ToString::to_string).collect(),
    };
    let any = response.tiers().next().is_some();
    (any.then_some(response), missing)
}

fn keep<T>(
    tier: &'static str,
    fitted: Result<T, ResponseError>,
    missing: &mut Vec<MissingTier>,
) -> Option<T> {
    fitted.map_err(|reason| missing.push(MissingTier { tier, reason })).ok()
}
