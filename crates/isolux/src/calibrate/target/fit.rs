//! From measured windows to the terms `spline`, `profile` and `angle`.
//!
//! A distance sweep's spline, where there is one, is kept and taken as known: its target faced the camera in the
//! middle of the image, so that neither profile nor angle could bend it. An exposure sweep's table is taken as known
//! too; otherwise every integration time gets a factor of its own, which is not given out: labels of a few windows
//! make no table.

use super::report::TargetReport;
use super::rows::Rows;
use super::{TargetWindows, gloss, terms};
use crate::calibrate::joint::{self, AngleModel, Factor, JointFit, JointModel, Observation};
use crate::calibrate::{CalibrateError, CalibrateSettings, FitWarning};
use crate::calibration::Calibration;

/// Parts that the frames are divided into for the held-out residual.
const FOLDS: u32 = 5;
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
    let held_out = held_out(&rows, &fit.model);
    let words = warnings[about_targets..].iter().map(ToString::to_string).collect();
    let warning = terms::write(&rows, &fit, held_out, words, targets, calibration);
    warnings.extend(warning);
    Ok(TargetReport {
        surfaces,
        lambert_assumed: fit.model.angle == AngleModel::Fixed(crate::terms::angle::LAMBERT),
        unknowns: fit.unknowns,
        rank: fit.rank,
        sigma: fit.sigma,
        findings: fit.findings,
    })
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
            warnings.push(FitWarning::FactorRefused { reason, unknowns: fit.unknowns, rank: fit.rank });
        }
    }
    Ok(fit)
}

/// The smoothness that predicts frames best that are left out; of equals, the least. The windows of one frame share
/// the errors of its pose, so that independent errors, for which 1 is right, are the exception.
fn smoothness(rows: &Rows) -> f64 {
    let tried = SMOOTHNESS.map(|smoothness| {
        let model = JointModel { smoothness, ..rows.model };
        (smoothness, held_out(rows, &model).unwrap_or(f64::INFINITY))
    });
    tried
        .into_iter()
        .reduce(|best, next| if next.1 < best.1 { next } else { best })
        .map_or(1.0, |best| best.0)
}

/// Root mean square of the relative error on frames that were left out in turn; `None` with too few frames.
fn held_out(rows: &Rows, model: &JointModel) -> Option<f64> {
    let frames = rows.frames.iter().max().map_or(0, |last| last + 1);
    if frames < FOLDS {
        return None;
    }
    let mut squares = (0.0, 0.0);
    for fold in 0..FOLDS {
        let mut training = rows.observations.clone();
        let tested =
            |index: &usize| rows.frames[*index] % FOLDS == fold && rows.observations[*index].weight > 0.0;
        let tested: Vec<usize> = (0..training.len()).filter(tested).collect();
        tested.iter().for_each(|&index| training[index].weight = 0.0);
        let Ok(fit) = joint::solve(&training, model) else { continue };
        // Outliers of the whole are no test of the law: their share is told beside it.
        let cutoff = crate::calibrate::joint::CUTOFF * fit.sigma;
        let errors = tested.iter().map(|&index| {
            let scale = f64::from(rows.observations[index].weight).sqrt();
            (fit.residuals[index], fit.residuals[index].abs() * scale < cutoff)
        });
        for (error, _) in errors.filter(|(error, inside)| error.is_finite() && *inside) {
            squares = (squares.0 + error.exp_m1().powi(2), squares.1 + 1.0);
        }
    }
    (squares.1 > 0.0).then(|| (squares.0 / squares.1).sqrt())
}
