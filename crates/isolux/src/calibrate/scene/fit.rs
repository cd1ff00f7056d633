//! Fits the terms `lut`, `response`, `spline`, `profile` and `angle` to observations.
//!
//! Terms that were fitted to sweeps and targets are kept, because their surfaces are known. Scenes add the absent
//! ones.

use super::joint_input::JointInput;
use super::report::{SceneReport, SceneUse};
use super::{MotionFinding, SceneObservations, SceneWarning, lambert};
use crate::calibrate::CalibrateSettings;
use crate::calibrate::exposure::{ExposureCurve, MissingTier, fit_response};
use crate::calibrate::factor_terms::{FactorWarning, Fitted, held_out};
use crate::calibrate::joint::{Factor, JointError, JointFit, JointModel};
use crate::calibrate::levels::show_one_exposure;
use crate::calibrate::measure_error::{UnlikeShapes, common_shape};
use crate::calibration::Calibration;
use crate::terms::lut::{LutError, RelativeSample};
use crate::terms::{FitQuality, Lut};

/// One frame in five is left out once for the held-out residual; scenes have enough observations.
const HELD_OUT_FOLDS: std::ops::Range<u32> = 2..3;

/// Fits the terms that the scenes determine, and that are absent, into `calibration`. Whatever was left out, and why,
/// comes with the report.
///
/// # Errors
/// [`UnlikeShapes`] when the recordings have unlike formats.
pub(in crate::calibrate) fn fit(
    settings: &CalibrateSettings,
    scenes: &[SceneObservations],
    calibration: &mut Calibration,
) -> Result<(SceneReport, Vec<SceneWarning>), UnlikeShapes> {
    common_shape(used(scenes).map(|scene| (&*scene.source.recording, scene.shape)))?;
    let mut warnings = about(scenes);
    let (input, fit) = match solve(settings, scenes, &mut warnings) {
        Ok(solved) => solved,
        Err(warning) => {
            warnings.push(warning);
            return Ok((SceneReport::nothing(scenes), warnings));
        }
    };
    let factors = fit.findings.iter().map(|finding| finding.factor);
    let refused = factors.filter_map(|factor| FactorWarning::refused(&fit, factor));
    warnings.extend(refused.chain(FactorWarning::uncertain(&fit)).map(SceneWarning::Factor));
    let fitted = Fitted {
        observations: &input.observations,
        fit: &fit,
        held_out_residual: held_out(&input.observations, &fit.model, HELD_OUT_FOLDS),
        fitted_on: used(scenes).map(|scene| scene.source.clone()).collect(),
        warnings: warnings.iter().map(ToString::to_string).collect(),
    };
    write(settings, &input, &fitted, calibration, &mut warnings);
    let missing = fill_in_response(settings, scenes, calibration);
    warnings.extend(missing.into_iter().map(SceneWarning::NoTier));
    let report = SceneReport {
        scenes: scenes.iter().map(SceneUse::of).collect(),
        observations: fit.residuals.iter().filter(|residual| residual.is_finite()).count(),
        surfaces: fit.surfaces,
        outlier_share: outlier_share(&fit),
        sigma: fit.sigma,
        unknowns: fit.unknowns,
        rank: fit.rank,
        held_out_residual: fitted.held_out_residual,
        findings: fit.findings.clone(),
    };
    Ok((report, warnings))
}

/// The observations and their fit; a warning where there is nothing that could be fitted.
fn solve(
    settings: &CalibrateSettings,
    scenes: &[SceneObservations],
    warnings: &mut Vec<SceneWarning>,
) -> Result<(JointInput, JointFit), SceneWarning> {
    let nothing = |reason: JointError| SceneWarning::NothingFitted { reason };
    let input = JointInput::new(settings, scenes)
        .ok_or_else(|| nothing(JointError::TooFew { found: 0, expected: 2 }))?;
    let JointModel { time, distance, profile, .. } = input.model;
    if time.is_none() && distance.is_none() && profile.is_none() {
        let unknown = input.levels.of_frames();
        return Err(if unknown { SceneWarning::StillAtUnknownTimes } else { SceneWarning::NothingVaries });
    }
    let free = lambert::settle(&input).map_err(nothing)?;
    if !time.is_some_and(|time| time.of_frames) {
        let Some(shared) = FactorWarning::shared_by_frames(&input.observations, &free) else {
            return Ok((input, free));
        };
        warnings.push(SceneWarning::Factor(shared));
        if distance.is_none() {
            return Ok((input, free));
        }
        // The stated times are wrong: laws that were fitted with them would be too.
        let own = input.with_levels_of_frames();
        let fit = lambert::settle(&own).map_err(nothing)?;
        return Ok((own, fit));
    }
    let one = JointInput { model: JointModel { time: None, ..input.model }, ..input.clone() };
    let shared = lambert::settle(&one).map_err(nothing)?;
    Ok(if show_one_exposure(&shared, &free) { (one, shared) } else { (input, free) })
}

/// Fits the response to still scenes at several times, if no sweep was given.
fn fill_in_response(
    settings: &CalibrateSettings,
    scenes: &[SceneObservations],
    calibration: &mut Calibration,
) -> Vec<MissingTier> {
    if calibration.terms.response.is_some() {
        return Vec::new();
    }
    let several = |curve: &&ExposureCurve| curve.samples.len() > 1;
    let curves: Vec<ExposureCurve> =
        scenes.iter().filter_map(|scene| scene.exposure.as_ref()).filter(several).cloned().collect();
    let Some(lut) = calibration.terms.lut.as_ref().filter(|_| !curves.is_empty()) else {
        return Vec::new();
    };
    let (response, missing) = fit_response(settings, &curves, lut);
    calibration.terms.response = response;
    missing
}

/// Share of the weighted observations that the fit has rejected.
fn outlier_share(fit: &JointFit) -> f64 {
    let taken = fit.residuals.iter().zip(&fit.weights).filter(|(residual, _)| residual.is_finite());
    let (all, rejected) = taken
        .fold((0.0, 0.0), |(all, out), (_, weight)| (all + 1.0, out + f64::from(u8::from(*weight == 0.0))));
    if all > 0.0 { rejected / all } else { 0.0 }
}

fn used(scenes: &[SceneObservations]) -> impl Iterator<Item = &SceneObservations> {
    scenes.iter().filter(|scene| !scene.observations.is_empty())
}

/// Warnings about single recordings.
fn about(scenes: &[SceneObservations]) -> Vec<SceneWarning> {
    let warning = |scene: &SceneObservations| {
        let recording = scene.source.recording.clone();
        match &scene.motion {
            MotionFinding::Refused(reason) => {
                Some(SceneWarning::MotionRefused { recording, reason: *reason })
            }
            _ if scene.observations.is_empty() => Some(SceneWarning::Useless { recording }),
            _ => None,
        }
    };
    scenes.iter().filter_map(warning).collect()
}

/// Writes the terms that are determined and were absent.
fn write(
    settings: &CalibrateSettings,
    input: &JointInput,
    fitted: &Fitted<'_>,
    calibration: &mut Calibration,
    warnings: &mut Vec<SceneWarning>,
) {
    let terms = &mut calibration.terms;
    let lut = lut(settings, input, fitted).unwrap_or_else(|reason| {
        warnings.push(SceneWarning::NoTable { reason });
        None
    });
    if fill_in("lut", &mut terms.lut, lut, warnings) {
        calibration.reference.integration_time_us = settings.reference.integration_time_us;
    }
    let spline = fitted.spline().unwrap_or_else(|warning| {
        warnings.push(SceneWarning::Factor(warning));
        None
    });
    fill_in("spline", &mut terms.spline, spline, warnings);
    fill_in("profile", &mut terms.profile, fitted.profile(), warnings);
    fill_in("angle", &mut terms.angle, fitted.angle(), warnings);
}

/// Puts the fitted term into `place` if that is empty, and returns whether it did; an existing term is kept.
fn fill_in<T>(
    term: &'static str,
    place: &mut Option<T>,
    found: Option<T>,
    warnings: &mut Vec<SceneWarning>,
) -> bool {
    match (place.is_some(), found) {
        (_, None) => false,
        (true, Some(_)) => {
            warnings.push(SceneWarning::TermKept { term });
            false
        }
        (false, found) => {
            *place = found;
            true
        }
    }
}

/// The factors over integration time as a table: a scalar for each time, the median of many surfaces instead of the
/// mean of an image.
fn lut(
    settings: &CalibrateSettings,
    input: &JointInput,
    fitted: &Fitted<'_>,
) -> Result<Option<Lut>, LutError> {
    let finding = fitted.fit.findings.iter().find(|finding| finding.factor == Factor::Time);
    let Some((ln_time, finding)) = fitted.fit.ln_time.as_ref().zip(finding) else { return Ok(None) };
    let sample = |(&integration_time_us, s): (&f64, &f64)| RelativeSample {
        integration_time_us,
        relative_amplitude: s.exp(),
        spread: finding.standard_error,
    };
    let samples: Vec<RelativeSample> = input.levels.times_us.iter().zip(ln_time).map(sample).collect();
    let lut = Lut::of_curve(&samples, settings.reference_time_us())?;
    let fit = FitQuality { points: lut.fit.points, ..fitted.quality() };
    let lut = Lut { fit, ..lut };
    Ok(Some(lut.with_origin(fitted.fitted_on.clone(), fitted.warnings.clone())))
}
