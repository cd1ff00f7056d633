//! Fits the terms `spline`, `profile` and `angle` to measured windows.
//!
//! The spline of a distance sweep, if there is one, is kept and taken as known: its target faced the camera in the
//! middle of the image, so that neither profile nor angle could distort it. The table of an exposure sweep is taken
//! as known too. Without a table, every integration time gets a factor of its own, which does not become a term: a
//! few windows do not make a table.

use super::joint_input::JointInput;
use super::report::TargetReport;
use super::{TargetError, TargetWarning, TargetWindows, flatness, gloss};
use crate::calibrate::CalibrateSettings;
use crate::calibrate::factor_terms::{FOLDS, FactorWarning, Fitted, held_out};
use crate::calibrate::joint::{self, AngleModel, Factor, JointError, JointFit, JointModel, Observation};
use crate::calibrate::levels::{look_like_one_exposure, show_one_exposure};
use crate::calibration::{Calibration, Terms};
use crate::terms::angle::LAMBERT;

/// Factors on the weight of smoothness that are tried.
const SMOOTHNESS: [f64; 5] = [1.0, 10.0, 100.0, 1e3, 1e4];

/// Fits the terms that the windows determine into `calibration`. Whatever was left out, and why, comes with the report.
///
/// # Errors
/// [`TargetError`] when there is nothing to fit.
pub(in crate::calibrate) fn fit(
    settings: &CalibrateSettings,
    targets: &[TargetWindows],
    calibration: &mut Calibration,
) -> Result<(TargetReport, Vec<TargetWarning>), TargetError> {
    let mut warnings = Vec::new();
    let mut input = JointInput::new(settings, targets, calibration, &mut warnings)?;
    // Unknown exposures are left for later: glossy materials would be taken for them.
    let of_frames = input.model.time.filter(|time| time.of_frames);
    input.model.time = input.model.time.filter(|time| !time.of_frames);
    let first = joint::solve(&input.observations, &input.model)?;
    input.expect(targets, &first.residuals);
    warnings.extend(targets.iter().filter_map(curved));
    let mut surfaces = gloss::judge(&input, targets, &mut warnings);
    let left_out: Vec<bool> = surfaces.iter().map(|surface| surface.left_out).collect();
    input.leave_out(&left_out);
    input.model.smoothness = smoothness(&input);
    if let Some(time) = of_frames {
        let shared = joint::solve(&input.observations, &input.model)?;
        let own = JointModel { time: Some(time), ..input.model };
        let residuals =
            input.observations.iter().map(|seen| seen.frame).zip(shared.residuals.iter().copied());
        let one = look_like_one_exposure(&shared, residuals.filter(|(_, residual)| residual.is_finite()));
        if !one && !show_one_exposure(&shared, &joint::solve(&input.observations, &own)?) {
            input.model = own;
            input.model.smoothness = smoothness(&input);
        }
    }
    let fit = determined(&input.observations, input.model, &mut warnings)?;
    // Without angles, each frame's own tilt is what its residuals share.
    if of_frames.is_none() && fit.model.angle != AngleModel::Absent {
        let shared = FactorWarning::shared_by_frames(&input.observations, &fit);
        warnings.extend(shared.map(TargetWarning::Factor));
    }
    for (surface, used) in surfaces.iter_mut().enumerate() {
        let mine = input.observations.iter().zip(&fit.weights).filter(|(o, _)| o.surface as usize == surface);
        used.outliers = mine.filter(|(_, weight)| **weight == 0.0).count();
    }
    let fitted = Fitted {
        observations: &input.observations,
        fit: &fit,
        held_out_residual: held_out(&input.observations, &fit.model, 0..FOLDS),
        fitted_on: targets.iter().map(|target| target.source.clone()).collect(),
        warnings: warnings.iter().map(ToString::to_string).collect(),
    };
    if fit.model.angle == AngleModel::Absent && !settings.accept_poor_fit {
        warnings.push(TargetWarning::NoAngles);
    } else {
        warnings.extend(write(&fitted, &mut calibration.terms).map(TargetWarning::Factor));
    }
    let report = TargetReport {
        surfaces,
        lambert_assumed: fit.model.angle == AngleModel::Fixed(LAMBERT),
        unknowns: fit.unknowns,
        rank: fit.rank,
        sigma: fit.sigma,
        findings: fit.findings,
    };
    Ok((report, warnings))
}

fn curved(target: &TargetWindows) -> Option<TargetWarning> {
    let flatness::Curved { deviation_m, focal_factor } = flatness::curved(target)?;
    let recording = target.source.recording.clone();
    Some(TargetWarning::Curved { recording, deviation_m, focal_factor })
}

/// Writes the determined factors over distance, image and angle into `terms`.
fn write(fitted: &Fitted<'_>, terms: &mut Terms) -> Option<FactorWarning> {
    let spline = fitted.spline();
    if let Ok(Some(spline)) = &spline {
        terms.spline = Some(spline.clone());
    }
    terms.profile = fitted.profile().or(terms.profile.take());
    terms.angle = fitted.angle().or(terms.angle.take());
    spline.err()
}

/// The fit of the largest model whose factors are not confounded. Each refusal becomes a warning.
fn determined(
    observations: &[Observation],
    mut model: JointModel,
    warnings: &mut Vec<TargetWarning>,
) -> Result<JointFit, JointError> {
    let mut fit = joint::solve(observations, &model)?;
    if let Some(refused) = FactorWarning::refused(&fit, Factor::Angle) {
        warnings.push(TargetWarning::Factor(refused));
        warnings.push(TargetWarning::LambertAssumed);
        model.angle = AngleModel::Fixed(LAMBERT);
        fit = joint::solve(observations, &model)?;
    }
    let others = [Factor::Time, Factor::Distance, Factor::Profile];
    let refused = others.into_iter().filter_map(|factor| FactorWarning::refused(&fit, factor));
    warnings.extend(refused.chain(FactorWarning::uncertain(&fit)).map(TargetWarning::Factor));
    Ok(fit)
}

/// The smoothness that predicts frames best that are left out; of equals, the least. The windows of one frame share
/// the errors of its pose, so that independent errors, for which 1 is right, are the exception.
fn smoothness(input: &JointInput) -> f64 {
    let tried = SMOOTHNESS.map(|smoothness| {
        let model = JointModel { smoothness, ..input.model };
        let held_out = held_out(&input.observations, &model, 0..FOLDS);
        (smoothness, held_out.unwrap_or(f64::INFINITY))
    });
    tried
        .into_iter()
        .reduce(|best, next| if next.1 < best.1 { next } else { best })
        .map_or(1.0, |best| best.0)
}
