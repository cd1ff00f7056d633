//! The factors of the joint model: how well they predict, and how they become terms of the calibration.

use std::collections::{BTreeMap, HashSet};
use std::fmt;
use std::ops::Range;

use super::joint::{self, Factor, Finding, JointFit, JointModel, Observation, Refusal};
use super::levels::{self, SharedByFrames};
use super::severity::{DOUBTFUL_SHARE, POOR_SHARE, Severity};
use crate::advice::{Advice, RecordingField};
use crate::numerics::robust::TUKEY_CUTOFF;
use crate::numerics::statistics::median;
use crate::terms::{Angle, FitQuality, Profile, Source, Spline, root_mean_square};

/// Cells of the image whose ln v has a larger predicted standard error are outside the profile's support.
const LARGEST_CELL_ERROR: f64 = 0.05;
/// Parts that the frames are divided into for the held-out residual.
pub(super) const FOLDS: u32 = 5;

/// Root mean square of the relative error on the frames of these `folds`, each left out in turn; `None` with too
/// few frames.
pub(super) fn held_out(observations: &[Observation], model: &JointModel, folds: Range<u32>) -> Option<f64> {
    if observations.iter().map(|observation| observation.frame + 1).max().unwrap_or(0) < FOLDS {
        return None;
    }
    let mut squares = (0.0, 0.0);
    for fold in folds {
        let mut training = observations.to_vec();
        let tested =
            |index: &usize| observations[*index].frame % FOLDS == fold && observations[*index].weight > 0.0;
        let tested: Vec<usize> = (0..training.len()).filter(tested).collect();
        tested.iter().for_each(|&index| training[index].weight = 0.0);
        let Ok(fit) = joint::solve(&training, model) else { continue };
        // Outliers of the whole fit do not test the law; their share is reported separately.
        let cutoff = TUKEY_CUTOFF * fit.sigma;
        let mut errors: Vec<f64> = tested.iter().map(|&index| fit.residuals[index]).collect();
        if model.time.is_some() {
            take_out_unknown_levels(observations, &training, &tested, &mut errors);
        }
        let errors = tested.iter().zip(errors).map(|(&index, error)| {
            let scale = f64::from(observations[index].weight).sqrt();
            (error, error.abs() * scale < cutoff)
        });
        for (error, _) in errors.filter(|(error, inside)| error.is_finite() && *inside) {
            squares = (squares.0 + error.exp_m1().powi(2), squares.1 + 1.0);
        }
    }
    (squares.1 > 0.0).then(|| (squares.0 / squares.1).sqrt())
}

/// Nothing is known of an exposure that only frames have which were left out: their median error is that.
fn take_out_unknown_levels(
    observations: &[Observation],
    training: &[Observation],
    tested: &[usize],
    errors: &mut [f64],
) {
    let known: HashSet<u16> =
        training.iter().filter(|seen| seen.weight > 0.0).map(|seen| seen.time).collect();
    let mut of_times: BTreeMap<u16, Vec<usize>> = BTreeMap::new();
    for (at, &index) in tested.iter().enumerate() {
        of_times.entry(observations[index].time).or_default().push(at);
    }
    for places in of_times.into_iter().filter(|(time, _)| !known.contains(time)).map(|(_, places)| places) {
        let mut finite: Vec<f64> =
            places.iter().map(|&at| errors[at]).filter(|error| error.is_finite()).collect();
        let level = median(&mut finite).unwrap_or(0.0);
        places.iter().for_each(|&at| errors[at] -= level);
    }
}

/// A factor of the joint model that does not become a term.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum FactorWarning {
    /// A factor that the observations do not determine.
    Refused {
        /// Why.
        reason: Refusal,
        /// Unknowns of the model, without the brightness of each surface.
        unknowns: usize,
        /// Rank of its reduced normal matrix.
        rank: usize,
    },
    /// A factor that became a term, but of which errors that the observations of a frame share leave much uncertain.
    Uncertain {
        /// The factor.
        factor: Factor,
        /// Standard error of its curve, or for the angle of its effect at 60°.
        standard_error: f64,
    },
    /// The residuals of a frame share one sign: its exposure was not what the recording says.
    SharedByFrames {
        /// Factor of the darkest and of the brightest frame.
        range: [f64; 2],
        /// Relative standard deviation of the frames' factors.
        spread: f64,
    },
    /// A distance law whose observations do not cover the reference distance.
    ReferenceNotSeen {
        /// Reference, m.
        reference_m: f64,
        /// Observed distances, least and greatest, m.
        seen_m: [f64; 2],
    },
}

impl FactorWarning {
    /// The warning about one factor, if it was refused.
    pub(super) fn refused(fit: &JointFit, factor: Factor) -> Option<Self> {
        let reason = fit.refusal(factor)?.clone();
        Some(Self::Refused { reason, unknowns: fit.unknowns, rank: fit.rank })
    }

    /// The warning about frames whose residuals share one sign, if they do.
    pub(super) fn shared_by_frames(observations: &[Observation], fit: &JointFit) -> Option<Self> {
        let residuals = observations.iter().map(|seen| seen.frame).zip(fit.residuals.iter().copied());
        let SharedByFrames { range, spread } = levels::shared_by_frames(residuals)?;
        (spread > DOUBTFUL_SHARE).then_some(Self::SharedByFrames { range, spread })
    }

    /// How much it weighs.
    pub(super) fn severity(&self) -> Severity {
        match self {
            Self::SharedByFrames { spread, .. } if *spread > POOR_SHARE => Severity::Poor,
            Self::SharedByFrames { .. } | Self::Uncertain { .. } => Severity::Doubt,
            Self::Refused { .. } | Self::ReferenceNotSeen { .. } => Severity::Note,
        }
    }

    /// The warnings about factors that are known badly, but not refused.
    pub(super) fn uncertain(fit: &JointFit) -> impl Iterator<Item = Self> + '_ {
        let vague =
            |finding: &&Finding| finding.refusal.is_none() && finding.standard_error > Finding::LARGEST_ERROR;
        let warning = |finding: &Finding| {
            let &Finding { factor, standard_error, .. } = finding;
            Self::Uncertain { factor, standard_error }
        };
        fit.findings.iter().filter(vague).map(warning)
    }

    /// What the user can do about it.
    #[must_use]
    pub fn advice(&self) -> Option<Advice> {
        match self {
            Self::Refused { reason: Refusal::Confounded { with, .. }, .. }
                if with.contains(&Factor::Exposure) =>
            {
                Some(Advice::WriteField(RecordingField::IntegrationTime))
            }
            Self::SharedByFrames { .. } => Some(Advice::RecordTimes),
            Self::Refused { .. } | Self::Uncertain { .. } => None,
            Self::ReferenceNotSeen { .. } => Some(Advice::ReferenceDistance { distance_m: None }),
        }
    }
}

impl fmt::Display for FactorWarning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Refused { reason, unknowns, rank } => {
                write!(f, "no {reason} (rank {rank} of {unknowns} unknowns)")
            }
            Self::Uncertain { factor, standard_error } => write!(
                f,
                "{}: known to {:.1} % only, because the observations of a frame share their errors: record more frames, \
                 in other poses",
                factor.name(),
                100.0 * standard_error
            ),
            Self::SharedByFrames { range: [least, largest], spread } => write!(
                f,
                "all that is seen in a frame shares a factor, {least:.2} to {largest:.2} from frame to frame ({:.1} % on \
                 average), which the integration times that the recording states do not explain: the exposure changed \
                 unrecorded, or frames were scaled one by one",
                100.0 * spread
            ),
            Self::ReferenceNotSeen { reference_m, seen_m: [min_m, max_m] } => write!(
                f,
                "no spline, surfaces were seen from {min_m:.3} to {max_m:.3} m and not at the reference distance of \
                 {reference_m} m: record there, or choose another"
            ),
        }
    }
}

/// A fit, and what the calibration records about it.
pub(super) struct Fitted<'a> {
    pub(super) observations: &'a [Observation],
    pub(super) fit: &'a JointFit,
    pub(super) held_out_residual: Option<f64>,
    pub(super) fitted_on: Vec<Source>,
    /// What was left out, and why, in words.
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

    /// The law over distance; `None` where it is not determined.
    pub(super) fn spline(&self) -> Result<Option<Spline>, FactorWarning> {
        let Some(law) = &self.fit.distance else { return Ok(None) };
        let (reference_m, seen_m) = (law.reference_distance_m, law.valid_distance_m);
        if !(seen_m[0]..=seen_m[1]).contains(&reference_m) {
            return Err(FactorWarning::ReferenceNotSeen { reference_m, seen_m });
        }
        let spline = Spline {
            version: Spline::VERSION,
            law: law.clone(),
            fitted_on: self.fitted_on.clone(),
            fit: self.quality(),
            warnings: self.warnings.clone(),
        };
        Ok(Some(spline).filter(|spline| spline.check().is_ok()))
    }

    /// The illumination profile; `None` where it is not determined.
    pub(super) fn profile(&self) -> Option<Profile> {
        let profile = self.fit.profile.as_ref()?;
        let supported =
            |cell: usize| profile.cell_errors[cell].is_some_and(|error| error <= LARGEST_CELL_ERROR);
        let profile = Profile {
            version: Profile::VERSION,
            map: profile.map.clone(),
            support: Profile::support_map(supported),
            fitted_on: self.fitted_on.clone(),
            fit: self.quality(),
            warnings: self.warnings.clone(),
        };
        Some(profile).filter(|profile| profile.check().is_ok())
    }

    /// The exponent of the cosine; `None` where it is not determined.
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

    /// Range of the observed cosines, without the outermost thousandth at either end.
    fn cosines(&self) -> [f64; 2] {
        let kept = self.observations.iter().zip(&self.fit.weights).filter(|(_, weight)| **weight > 0.0);
        let mut cosines: Vec<f64> = kept.map(|(observation, _)| f64::from(observation.cosine)).collect();
        [0.001, 0.999].map(|share| crate::numerics::statistics::quantile(&mut cosines, share).unwrap_or(1.0))
    }
}
