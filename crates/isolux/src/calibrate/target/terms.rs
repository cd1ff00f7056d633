//! The fitted factors as terms of the calibration.

use super::TargetWindows;
use super::rows::Rows;
use crate::calibrate::FitWarning;
use crate::calibrate::joint::{Factor, JointFit};
use crate::calibration::Calibration;
use crate::terms::{Angle, FitQuality, Profile, Source, Spline, root_mean_square};

/// Cells of the image whose ln v has a larger predicted standard error do not belong to the profile's support.
const LARGEST_CELL_ERROR: f64 = 0.05;

/// Writes the determined factors into `calibration`; a spline that a distance sweep gave stays.
pub(super) fn write(
    rows: &Rows,
    fit: &JointFit,
    held_out_residual: Option<f64>,
    warnings: Vec<String>,
    targets: &[TargetWindows],
    calibration: &mut Calibration,
) -> Option<FitWarning> {
    let mut warning = None;
    let kept = || fit.residuals.iter().zip(&fit.weights).filter(|(_, weight)| **weight > 0.0);
    let quality = FitQuality {
        points: kept().count(),
        residual: root_mean_square(kept().map(|(residual, _)| residual.exp_m1())).unwrap_or(0.0),
        held_out_residual,
    };
    let fitted_on: Vec<Source> = targets
        .iter()
        .map(|target| Source {
            recording: target.recording.clone(),
            frames_used: target.frames_used,
            frames_left_out: target.frames - target.frames_used,
        })
        .collect();
    if let Some(law) = &fit.distance {
        let [min_m, max_m] = law.valid_distance_m;
        let spline = Spline {
            version: Spline::VERSION,
            reference_distance_m: rows.reference_m,
            valid_distance_m: law.valid_distance_m,
            coefficients: law.coefficients.clone(),
            harmonic: law.harmonic,
            curvature_weight: law.curvature_weight,
            fitted_on: fitted_on.clone(),
            fit: quality.clone(),
            warnings: warnings.clone(),
        };
        if !(min_m..=max_m).contains(&rows.reference_m) {
            let (reference_m, seen_m) = (rows.reference_m, law.valid_distance_m);
            warning = Some(FitWarning::ReferenceNotSeen { reference_m, seen_m });
        } else if spline.check().is_ok() {
            calibration.terms.spline = Some(spline);
        }
    }
    if let Some(profile) = &fit.profile {
        let supported =
            |cell: usize| profile.cell_errors[cell].is_some_and(|error| error <= LARGEST_CELL_ERROR);
        let profile = Profile {
            version: Profile::VERSION,
            height: profile.places.shape.height,
            width: profile.places.shape.width,
            origin_px: profile.places.origin,
            radial: profile.radial,
            tensor: profile.tensor.clone(),
            support: Profile::support_map(supported),
            fitted_on: fitted_on.clone(),
            fit: quality.clone(),
            warnings: warnings.clone(),
        };
        if profile.check().is_ok() {
            calibration.terms.profile = Some(profile);
        }
    }
    let finding = fit.findings.iter().find(|finding| finding.factor == Factor::Angle);
    if let (Some(exponent), Some(finding)) = (fit.angle_exponent, finding) {
        let angle = Angle {
            version: Angle::VERSION,
            exponent,
            // The finding is the error of the effect at 60°, where ln cosθ = −ln 2.
            standard_error: finding.standard_error / 2f64.ln(),
            valid_cosine: cosines(rows, fit),
            fitted_on,
            fit: quality,
            warnings,
        };
        if angle.check().is_ok() {
            calibration.terms.angle = Some(angle);
        }
    }
    warning
}

/// Cosines that all but the outermost thousandths of the windows lie between.
fn cosines(rows: &Rows, fit: &JointFit) -> [f64; 2] {
    let kept = rows.observations.iter().zip(&fit.weights).filter(|(_, weight)| **weight > 0.0);
    let mut cosines: Vec<f64> = kept.map(|(observation, _)| f64::from(observation.cosine)).collect();
    [0.001, 0.999].map(|share| crate::statistics::quantile(&mut cosines, share).unwrap_or(1.0))
}
