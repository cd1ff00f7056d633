//! From measured windows to the terms `spline`, `profile` and `angle`.
//!
//! A distance sweep's spline, where there is one, is kept and taken as known: its target faced the camera in the
//! middle of the image, so that neither profile nor angle could bend it. An exposure sweep's table is taken as known
//! too; otherwise every integration time gets a factor of its own, which is not given out: labels of a few windows
//! make no table.

use super::report::TargetReport;
use super::rows::Rows;
use super::{TargetWindows, gloss};
use crate::calibrate::factors::{FOLDS, Fitted, held_out};
use crate::calibrate::joint::{self, AngleModel, Factor, JointFit, JointModel, Observation};
use crate::calibrate::{CalibrateError, CalibrateSettings, FitWarning};
use crate::calibration::Calibration;
use crate::terms::Source;

/// Factors on the weight of smoothness that are tried.
const SMOOTHNESS: [f64; 5] = [1.0, 10.0, 100.0, 1e3, 1e4];

/// Fits the terms that the windows determine into `calibration`. Whatever was left out, and why, goes to `warnings`.
///
/// # Errors
/// [`CalibrateError::Target`] when there is nothing to fit.
pub(in crate::calibrate) fn fit(
    settings: &CalibrateSettings,
    targets: &[TargetWindows],
    calibration: &mut Calibration,
    warnings: &mut Vec<FitWarning>,
) -> Result<TargetReport, CalibrateError> {
    let about_targets = warnings.len();
    let mut rows = Rows::new(settings, targets, calibration, warnings)?;
    let mut surfaces = gloss::judge(&rows, targets, warnings);
    let left_out: Vec<bool> = surfaces.iter().map(|surface| surface.left_out).collect();
    rows.leave_out(&left_out);
    rows.model.smoothness = smoothness(&rows);
    let fit = determined(&rows.observations, rows.model, warnings).map_err(CalibrateError::Target)?;
    for (surface, used) in surfaces.iter_mut().enumerate() {
        let mine = rows.observations.iter().zip(&fit.weights).filter(|(o, _)| o.surface as usize == surface);
        used.outliers = mine.filter(|(_, weight)| **weight == 0.0).count();
    }
    let fitted = Fitted {
        of: "targets",
        observations: &rows.observations,
        fit: &fit,
        held_out_residual: held_out(&rows.observations, &rows.frames, &fit.model, 0..FOLDS),
        reference_m: rows.reference_m,
        fitted_on: targets.iter().map(source).collect(),
        warnings: warnings[about_targets..].iter().map(ToString::to_string).collect(),
    };
    warnings.extend(fitted.write(calibration));
    Ok(TargetReport {
        surfaces,
        lambert_assumed: fit.model.angle == AngleModel::Fixed(crate::terms::angle::LAMBERT),
        unknowns: fit.unknowns,
        rank: fit.rank,
        sigma: fit.sigma,
        findings: fit.findings,
    })
}

fn source(target: &TargetWindows) -> Source {
    Source {
        recording: target.recording.clone(),
        frames_used: target.frames_used,
        frames_left_out: target.frames - target.frames_used,
    }
}

/// The fit of the largest model whose factors are not confounded. Each refusal becomes a warning.
fn determined(
    observations: &[Observation],
    mut model: JointModel,
    warnings: &mut Vec<FitWarning>,
) -> Result<JointFit, joint::JointError> {
    let mut fit = joint::solve(observations, &model)?;
    if let Some(reason) = fit.refusal(Factor::Angle) {
        warnings.push(FitWarning::FactorRefused {
            of: "targets",
            reason: reason.clone(),
            unknowns: fit.unknowns,
            rank: fit.rank,
        });
        warnings.push(FitWarning::LambertAssumed);
        model.angle = AngleModel::Fixed(crate::terms::angle::LAMBERT);
        fit = joint::solve(observations, &model)?;
    }
    for factor in [Factor::Time, Factor::Distance, Factor::Profile] {
        if let Some(reason) = fit.refusal(factor) {
            let reason = reason.clone();
            warnings.push(FitWarning::FactorRefused {
                of: "targets",
                reason,
                unknowns: fit.unknowns,
                rank: fit.rank,
            });
        }
    }
    Ok(fit)
}

/// The smoothness that predicts frames best that are left out; of equals, the least. The windows of one frame share
/// the errors of its pose, so that independent errors, for which 1 is right, are the exception.
fn smoothness(rows: &Rows) -> f64 {
    let tried = SMOOTHNESS.map(|smoothness| {
        let model = JointModel { smoothness, ..rows.model };
        let held_out = held_out(&rows.observations, &rows.frames, &model, 0..FOLDS);
        (smoothness, held_out.unwrap_or(f64::INFINITY))
    });
    tried
        .into_iter()
        .reduce(|best, next| if next.1 < best.1 { next } else { best })
        .map_or(1.0, |best| best.0)
}
