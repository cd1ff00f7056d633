//! The factors of the joint model: how well they predict, and how they become terms of the calibration.

use std::ops::Range;

use super::FitWarning;
use super::joint::{self, Factor, JointFit, JointModel, Observation};
use crate::calibration::Calibration;
use crate::numerics::robust::TUKEY_CUTOFF;
use crate::terms::{Angle, FitQuality, Profile, Source, Spline, root_mean_square};

/// Cells of the image whose ln v has a larger predicted standard error do not belong to the profile's support.
const LARGEST_CELL_ERROR: f64 = 0.05;
/// Parts that the frames are divided into for the held-out residual.
pub(super) const FOLDS: u32 = 5;

/// Root mean square of the relative error on the frames of these `folds`, each left out in turn; `None` with too few
/// frames. `frames` has the frame of each observation.
pub(super) fn held_out(
    observations: &[Observation],
    frames: &[u32],
    model: &JointModel,
    folds: Range<u32>,
) -> Option<f64> {
    if frames.iter().max().map_or(0, |last| last + 1) < FOLDS {
        return None;
    }
    let mut squares = (0.0, 0.0);
    for fold in folds {
        let mut training = observations.to_vec();
        let tested = |index: &usize| frames[*index] % FOLDS == fold && observations[*index].weight > 0.0;
        let tested: Vec<usize> = (0..training.len()).filter(tested).collect();
        tested.iter().for_each(|&index| training[index].weight = 0.0);
        let Ok(fit) = joint::solve(&training, model) else { continue };
        // Outliers of the whole are no test of the law: their share is told beside it.
        let cutoff = TUKEY_CUTOFF * fit.sigma;
        let errors = tested.iter().map(|&index| {
            let scale = f64::from(observations[index].weight).sqrt();
            (fit.residuals[index], fit.residuals[index].abs() * scale < cutoff)
        });
        for (error, _) in errors.filter(|(error, inside)| error.is_finite() && *inside) {
            squares = (squares.0 + error.exp_m1().powi(2), squares.1 + 1.0);
        }
    }
    (squares.1 > 0.0).then(|| (squares.0 / squares.1).sqrt())
}

/// A fit, and what is to be said of it in the calibration.
pub(super) struct Fitted<'a> {
    /// What was observed: `targets` or `scenes`.
    pub(super) of: &'static str,
    pub(super) observations: &'a [Observation],
    pub(super) fit: &'a JointFit,
    pub(super) held_out_residual: Option<f64>,
    /// Distance at which the law is 1, m.
    pub(super) reference_m: f64,
    pub(super) fitted_on: Vec<Source>,
    pub(super) warnings: Vec<String>,
}

impl Fitted<'_> {
    /// How well all factors together fit.
    pub(super) fn quality(&self) -> FitQuality {
        let kept = || self.fit.residuals.iter().zip(&self.fit.weights).filter(|(_, weight)| **weight > 0.0);
        FitQuality {
            points: kept().count(),
            residual: root_mean_square(kept().map(|(residual, _)| residual.exp_m1())).unwrap_or(0.0),
            held_out_residual: self.held_out_residual,
        }
    }

    /// Writes the determined factors over distance, image and angle into `calibration`.
    pub(super) fn write(&self, calibration: &mut Calibration) -> Option<FitWarning> {
        let spline = self.spline();
        let terms = &mut calibration.terms;
        if let Ok(Some(spline)) = &spline {
            terms.spline = Some(spline.clone());
        }
        terms.profile = self.profile().or(terms.profile.take());
        terms.angle = self.angle().or(terms.angle.take());
        spline.err()
    }

    /// The law over distance, where it is determined.
    pub(super) fn spline(&self) -> Result<Option<Spline>, FitWarning> {
        let Some(law) = &self.fit.distance else { return Ok(None) };
        let [min_m, max_m] = law.valid_distance_m;
        let spline = Spline {
            version: Spline::VERSION,
            reference_distance_m: self.reference_m,
            valid_distance_m: law.valid_distance_m,
            coefficients: law.coefficients.clone(),
            harmonic: law.harmonic,
            curvature_weight: law.curvature_weight,
            fitted_on: self.fitted_on.clone(),
            fit: self.quality(),
            warnings: self.warnings.clone(),
        };
        if !(min_m..=max_m).contains(&self.reference_m) {
            let (of, reference_m, seen_m) = (self.of, self.reference_m, law.valid_distance_m);
            return Err(FitWarning::ReferenceNotSeen { of, reference_m, seen_m });
        }
        Ok(Some(spline).filter(|spline| spline.check().is_ok()))
    }

    /// The illumination profile, where it is determined.
    pub(super) fn profile(&self) -> Option<Profile> {
        let profile = self.fit.profile.as_ref()?;
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
            fitted_on: self.fitted_on.clone(),
            fit: self.quality(),
            warnings: self.warnings.clone(),
        };
        Some(profile).filter(|profile| profile.check().is_ok())
    }

    /// The exponent of the cosine, where it is determined.
    pub(super) fn angle(&self) -> Option<Angle> {
        let exponent = self.fit.angle_exponent?;
        let finding = self.fit.findings.iter().find(|finding| finding.factor == Factor::Angle)?;
        let angle = Angle {
            version: Angle::VERSION,
            exponent,
            // The finding is the error of the effect at 60°, where ln cosθ = −ln 2.
            standard_error: finding.standard_error / 2f64.ln(),
            valid_cosine: self.cosines(),
            fitted_on: self.fitted_on.clone(),
            fit: self.quality(),
            warnings: self.warnings.clone(),
        };
        Some(angle).filter(|angle| angle.check().is_ok())
    }

    /// Cosines that all but the outermost thousandths of the observations lie between.
    fn cosines(&self) -> [f64; 2] {
        let kept = self.observations.iter().zip(&self.fit.weights).filter(|(_, weight)| **weight > 0.0);
        let mut cosines: Vec<f64> = kept.map(|(observation, _)| f64::from(observation.cosine)).collect();
        [0.001, 0.999].map(|share| crate::numerics::statistics::quantile(&mut cosines, share).unwrap_or(1.0))
    }
}
