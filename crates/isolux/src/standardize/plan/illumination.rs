//! The steps that take the illumination profile and the angle of incidence out.

use super::Planner;
use crate::frame::{Channels, Intrinsics};
use crate::standardize::choice::{AngleStep, Method, ProfileStep};
use crate::standardize::report::{Note, PlanError};
use crate::terms::angle::{LAMBERT, LEAST_COSINE};
use crate::terms::profile::ProfileGains;

/// The two steps, ready to apply.
#[derive(Clone, Debug, Default, PartialEq)]
pub(in crate::standardize) struct IlluminationPlan {
    pub(in crate::standardize) profile: Option<ProfilePlan>,
    pub(in crate::standardize) angle: Option<AnglePlan>,
}

/// The multipliers of a whole image, computed once.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::standardize) struct ProfilePlan {
    pub(in crate::standardize) gains: ProfileGains,
}

/// What turns a cosine into a multiplier.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::standardize) struct AnglePlan {
    pub(in crate::standardize) exponent: f64,
    /// Cosines below this are flagged.
    pub(in crate::standardize) least_cosine: f64,
    pub(in crate::standardize) intrinsics: Intrinsics,
}

impl Planner<'_> {
    /// Plans both steps.
    ///
    /// # Errors
    /// [`PlanError`] when a step asked for by name cannot be done.
    pub(super) fn illumination(&mut self) -> Result<IlluminationPlan, PlanError> {
        Ok(IlluminationPlan { profile: self.profile()?, angle: self.angle()? })
    }

    /// `best` uses the profile that the calibration holds for this image format; the paper knows none.
    fn profile(&mut self) -> Result<Option<ProfilePlan>, PlanError> {
        let named = self.choice.profile == Some(ProfileStep::On);
        if self.choice.profile == Some(ProfileStep::Off) || (!named && self.choice.method == Method::Paper) {
            return Ok(None);
        }
        let held = self.calibration.and_then(|calibration| calibration.terms.profile.as_ref());
        let Some(profile) = held else {
            return if named { Err(self.missing("profile", "--target")) } else { Ok(None) };
        };
        let expected = profile.shape();
        if let Some(found) = self.stream.shape.filter(|shape| *shape != expected) {
            if named {
                return Err(PlanError::ProfileFormat { found, expected });
            }
            self.notes.push(Note::ProfileFormat { found, expected });
            return Ok(None);
        }
        let gains = profile.gains();
        let outside = gains.outside.iter().filter(|outside| **outside).count();
        let share = 100.0 * outside as f64 / gains.outside.len().max(1) as f64;
        let parameters =
            format!("{expected}, {share:.1} % of it outside the support (constant there, flagged)");
        self.step("profile", "profile", parameters);
        Ok(Some(ProfilePlan { gains }))
    }

    /// Off unless it is asked for.
    fn angle(&mut self) -> Result<Option<AnglePlan>, PlanError> {
        if self.choice.angle != Some(AngleStep::On) {
            return Ok(None);
        }
        self.has(Channels::DISTANCE, "angle", "angle", "distance", true)?;
        let Some(intrinsics) = self.stream.intrinsics.filter(Intrinsics::is_usable) else {
            return Err(PlanError::IntrinsicsMissing);
        };
        let plan = |exponent: f64, least_cosine: f64| AnglePlan { exponent, least_cosine, intrinsics };
        match self.calibration.and_then(|calibration| calibration.terms.angle.as_ref()) {
            Some(angle) => {
                let [least, _] = angle.valid_cosine;
                let parameters = format!(
                    "cos^-{:.3}, seen down to a cosine of {least:.2} (flagged below), clamped at {LEAST_COSINE}",
                    angle.exponent
                );
                self.step("angle", "angle", parameters);
                Ok(Some(plan(angle.exponent, least.max(LEAST_COSINE))))
            }
            None => {
                if self.calibration.is_some() {
                    self.notes.push(Note::Lambert);
                }
                self.step("angle", "lambert", format!("1 / cosθ, clamped at a cosine of {LEAST_COSINE}"));
                Ok(Some(plan(LAMBERT, LEAST_COSINE)))
            }
        }
    }
}
