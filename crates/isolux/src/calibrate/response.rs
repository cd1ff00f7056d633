//! From the evidence of exposure sweeps to the tiers of the response.

use super::warning::FitWarning;
use super::{CalibrateSettings, ExposureCurve};
use crate::terms::response::{
    AmplitudeResponse, AmplitudeStack, IntensityResponse, PhaseSampleResponse, PixelResponse, PixelSeries,
    Response, ResponseError, ScalarResponse,
};
use crate::terms::{Lut, Source};

/// Every tier that the sweeps determine. The mean curve is that of the table, in which several sweeps are merged
/// already. `None` when there is not even a scalar.
pub(super) fn fit_response(
    settings: &CalibrateSettings,
    curves: &[ExposureCurve],
    lut: &Lut,
    warnings: &mut Vec<FitWarning>,
) -> Option<Response> {
    let sources: Vec<Source> = curves.iter().map(|curve| curve.source.clone()).collect();
    let mut missing = Vec::new();
    let scalar = keep("scalar", ScalarResponse::fit(&lut.samples()), &mut missing)
        .map(|tier| ScalarResponse { fitted_on: sources.clone(), ..tier });
    let floors = curves.iter().filter_map(|curve| curve.noise_floor);
    let least_dn = floors.map(|floor| floor.low_signal_below_dn).fold(0.0, f64::max);
    let stacks: Vec<&AmplitudeStack> = curves.iter().map(|curve| &curve.evidence.stack).collect();
    let amplitude = keep("amplitude", AmplitudeResponse::fit(&stacks, least_dn), &mut missing)
        .map(|tier| AmplitudeResponse { fitted_on: sources.clone(), ..tier });
    // A map holds for one scene, so that several sweeps have none in common.
    let pixel = match stacks.as_slice() {
        [stack] => keep("pixel", PixelResponse::fit(stack, least_dn), &mut missing)
            .map(|tier| PixelResponse { fitted_on: sources.clone(), ..tier }),
        _ => None,
    };
    let pixels: Vec<PixelSeries> = curves.iter().flat_map(|c| c.evidence.pixels.iter().cloned()).collect();
    let delivered = |value: fn(&PixelSeries) -> bool| pixels.iter().any(value);
    let intensity = delivered(|series| series.iter().any(|m| m.intensity_dn.is_finite()))
        .then(|| keep("intensity", IntensityResponse::fit(&pixels), &mut missing))
        .flatten()
        .map(|tier| IntensityResponse { fitted_on: sources.clone(), ..tier });
    let phase_samples = delivered(|series| series.iter().any(|m| m.phase_samples_dn[0].is_finite()))
        .then(|| {
            let fitted = PhaseSampleResponse::fit(&pixels, settings.modulation_frequency_hz);
            keep("phase_samples", fitted, &mut missing)
        })
        .flatten()
        .map(|tier| PhaseSampleResponse { fitted_on: sources.clone(), ..tier });
    let words = missing.iter().map(ToString::to_string).collect();
    warnings.extend(missing);
    let response = Response {
        version: Response::VERSION,
        scalar,
        amplitude,
        pixel,
        intensity,
        phase_samples,
        warnings: words,
    };
    let any = response.tiers().next().is_some();
    any.then_some(response)
}

fn keep<T>(tier: &'static str, fitted: Result<T, ResponseError>, missing: &mut Vec<FitWarning>) -> Option<T> {
    fitted.map_err(|reason| missing.push(FitWarning::NoTier { tier, reason })).ok()
}
