//! From observations to the terms `lut`, `response`, `spline`, `profile` and `angle`.
//!
//! What sweeps and targets have fitted stays: they know their surfaces. Scenes fill in what is absent.

use super::lambert;
use super::report::{SceneReport, SceneUse};
use super::rows::Rows;
use super::{MotionFinding, SceneObservations};
use crate::calibrate::factors::{Fitted, held_out};
use crate::calibrate::joint::{Factor, JointError, JointFit, JointModel};
use crate::calibrate::{CalibrateError, CalibrateSettings, ExposureCurve, FitWarning, response};
use crate::calibration::{Calibration, REFERENCE_TIME_US};
use crate::terms::lut::ExposureSample;
use crate::terms::{FitQuality, Lut};

/// One frame in five is left out once, for the held-out residual: scenes have observations enough.
const HELD_OUT_FOLDS: std::ops::Range<u32> = 2..3;

/// Fits the terms that the scenes determine, and that are absent, into `calibration`. Whatever was left out, and why,
/// goes to `warnings`.
///
/// # Errors
/// [`CalibrateError::SceneShape`] when the recordings have unlike formats.
pub(in crate::calibrate) fn fit(
    settings: &CalibrateSettings,
    scenes: &[SceneObservations],
    calibration: &mut Calibration,
    warnings: &mut Vec<FitWarning>,
) -> Result<SceneReport, CalibrateError> {
    check_shapes(scenes)?;
    let about_scenes = warnings.len();
    warn(scenes, warnings);
    let (rows, fit) = match solve(settings, scenes) {
        Ok((rows, Ok(fit))) => (rows, fit),
        Ok((_, Err(reason))) => {
            warnings.push(FitWarning::NothingFromScenes { reason });
            return Ok(SceneReport::nothing(scenes));
        }
        Err(warning) => {
            warnings.push(warning);
            return Ok(SceneReport::nothing(scenes));
        }
    };
    for finding in &fit.findings {
        if let Some(reason) = finding.refusal.clone() {
            let (of, unknowns, rank) = ("scenes", fit.unknowns, fit.rank);
            warnings.push(FitWarning::FactorRefused { of, reason, unknowns, rank });
        }
    }
    let fitted = Fitted {
        of: "scenes",
        observations: &rows.observations,
        fit: &fit,
        held_out_residual: held_out(&rows.observations, &rows.frames, &fit.model, HELD_OUT_FOLDS),
        reference_m: settings.reference.distance_m,
        fitted_on: used(scenes).map(|scene| scene.source.clone()).collect(),
        warnings: warnings[about_scenes..].iter().map(ToString::to_string).collect(),
    };
    write(settings, &rows, &fitted, calibration, warnings);
    fit_response(settings, scenes, calibration, warnings);
    Ok(SceneReport {
        scenes: scenes.iter().map(SceneUse::of).collect(),
        observations: fit.residuals.iter().filter(|residual| residual.is_finite()).count(),
        surfaces: fit.surfaces,
        outlier_share: outlier_share(&fit),
        sigma: fit.sigma,
        unknowns: fit.unknowns,
        rank: fit.rank,
        held_out_residual: fitted.held_out_residual,
        findings: fit.findings.clone(),
    })
}

/// The rows and their fit; a warning where there is nothing that could be fitted.
fn solve(
    settings: &CalibrateSettings,
    scenes: &[SceneObservations],
) -> Result<(Rows, Result<JointFit, JointError>), FitWarning> {
    let rows = Rows::new(settings, scenes);
    let rows =
        rows.ok_or(FitWarning::NothingFromScenes { reason: JointError::TooFew { found: 0, expected: 2 } })?;
    let JointModel { time, distance, profile, .. } = rows.model;
    if time.is_none() && distance.is_none() && profile.is_none() {
        return Err(FitWarning::NothingVaries);
    }
    let fit = lambert::settle(&rows);
    Ok((rows, fit))
}

/// The compression of the pixels, from still scenes at several times, where no sweep has told it.
fn fit_response(
    settings: &CalibrateSettings,
    scenes: &[SceneObservations],
    calibration: &mut Calibration,
    warnings: &mut Vec<FitWarning>,
) {
    if calibration.terms.response.is_some() {
        return;
    }
    let several = |curve: &&ExposureCurve| curve.samples.len() > 1;
    let curves: Vec<ExposureCurve> =
        scenes.iter().filter_map(|scene| scene.exposure.as_ref()).filter(several).cloned().collect();
    let Some(lut) = calibration.terms.lut.as_ref().filter(|_| !curves.is_empty()) else { return };
    calibration.terms.response = response::fit_response(settings, &curves, lut, warnings);
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

fn check_shapes(scenes: &[SceneObservations]) -> Result<(), CalibrateError> {
    let Some(first) = used(scenes).next() else { return Ok(()) };
    let Some(other) = used(scenes).find(|scene| scene.shape != first.shape) else { return Ok(()) };
    let expected = format!("{}, as in {}", first.shape, first.source.recording);
    let (recording, found) = (other.source.recording.clone(), other.shape.to_string());
    Err(CalibrateError::SceneShape { recording, found, expected })
}

fn warn(scenes: &[SceneObservations], warnings: &mut Vec<FitWarning>) {
    for scene in scenes {
        let recording = scene.source.recording.clone();
        match &scene.motion {
            MotionFinding::Refused(reason) => {
                warnings.push(FitWarning::MotionRefused { recording, reason: *reason });
            }
            _ if scene.observations.is_empty() => warnings.push(FitWarning::SceneUseless { recording }),
            _ => {}
        }
    }
}

/// Writes what is determined and absent.
fn write(
    settings: &CalibrateSettings,
    rows: &Rows,
    fitted: &Fitted<'_>,
    calibration: &mut Calibration,
    warnings: &mut Vec<FitWarning>,
) {
    let mut put = Put { warnings };
    if let Some(lut) = lut(settings, rows, fitted, put.warnings)
        && put.at("lut", &mut calibration.terms.lut, Some(lut))
    {
        calibration.reference.integration_time_us = settings.reference.integration_time_us;
    }
    match fitted.spline() {
        Ok(spline) => {
            put.at("spline", &mut calibration.terms.spline, spline);
        }
        Err(warning) => put.warnings.push(warning),
    }
    put.at("profile", &mut calibration.terms.profile, fitted.profile());
    put.at("angle", &mut calibration.terms.angle, fitted.angle());
}

/// Puts terms where none are.
struct Put<'a> {
    warnings: &'a mut Vec<FitWarning>,
}

impl Put<'_> {
    /// True when the term was put.
    fn at<T>(&mut self, term: &'static str, place: &mut Option<T>, found: Option<T>) -> bool {
        match (place.is_some(), found) {
            (_, None) => false,
            (true, Some(_)) => {
                self.warnings.push(FitWarning::TermKept { term });
                false
            }
            (false, found) => {
                *place = found;
                true
            }
        }
    }
}

/// The factors over integration time as a table: a scalar for each time, the median of many surfaces instead of the
/// mean of an image.
fn lut(
    settings: &CalibrateSettings,
    rows: &Rows,
    fitted: &Fitted<'_>,
    warnings: &mut Vec<FitWarning>,
) -> Option<Lut> {
    let ln_time = fitted.fit.ln_time.as_ref()?;
    let finding = fitted.fit.findings.iter().find(|finding| finding.factor == Factor::Time)?;
    let sample = |(time_us, s): (&f64, &f64)| ExposureSample {
        integration_time_us: *time_us,
        mean_amplitude_dn: s.exp(),
        frame_spread: finding.standard_error,
    };
    let samples: Vec<ExposureSample> = rows.times_us.iter().zip(ln_time).map(sample).collect();
    let reference_us = settings.reference.integration_time_us.unwrap_or(REFERENCE_TIME_US);
    match Lut::fit(&samples, reference_us) {
        Ok(lut) => {
            let (fitted_on, warnings) = (fitted.fitted_on.clone(), fitted.warnings.clone());
            let fit = FitQuality { points: lut.fit.points, ..fitted.quality() };
            Some(Lut { fit, fitted_on, warnings, ..lut })
        }
        Err(reason) => {
            warnings.push(FitWarning::NoTable { reason });
            None
        }
    }
}
