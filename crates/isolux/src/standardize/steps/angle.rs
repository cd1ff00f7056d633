//! The step that removes the effect of the angle of incidence: a factor on the multipliers of a block.

use crate::frame::{Channels, Intrinsics, PixelFlags};
use crate::standardize::planner::Planner;
use crate::standardize::report::{Note, PlanError};
use crate::step_names::AngleStep;
use crate::terms::angle::{self, LAMBERT, LEAST_COSINE};

/// How a cosine becomes a multiplier.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct AnglePlan {
    exponent: f64,
    /// Cosines below this are flagged.
    least_cosine: f64,
    pub(crate) intrinsics: Intrinsics,
}

/// Plans the step; it is off unless it is asked for.
///
/// # Errors
/// [`PlanError`] when the recording lacks distance or intrinsics.
pub(crate) fn plan(planner: &mut Planner<'_>) -> Result<Option<AnglePlan>, PlanError> {
    if planner.choice.angle != Some(AngleStep::On) {
        return Ok(None);
    }
    planner.has(Channels::DISTANCE, ["angle", "angle", "distance"], true)?;
    let Some(intrinsics) = planner.traits.intrinsics.filter(Intrinsics::is_usable) else {
        return Err(PlanError::IntrinsicsMissing);
    };
    if let Some(angle) = planner.calibration.and_then(|calibration| calibration.terms.angle.as_ref()) {
        let [least, _] = angle.valid_cosine;
        let parameters = format!(
            "cos^-{:.3}, seen down to a cosine of {least:.2} (flagged below), clamped at {LEAST_COSINE}",
            angle.exponent
        );
        planner.step("angle", "angle", parameters);
        let least_cosine = least.max(LEAST_COSINE);
        return Ok(Some(AnglePlan { exponent: angle.exponent, least_cosine, intrinsics }));
    }
    if planner.calibration.is_some() {
        planner.notes.push(Note::Lambert);
    }
    planner.step("angle", "lambert", format!("1 / cosθ, clamped at a cosine of {LEAST_COSINE}"));
    Ok(Some(AnglePlan { exponent: LAMBERT, least_cosine: LEAST_COSINE, intrinsics }))
}

/// Multiplies the multipliers of pixels with these cosines, and flags pixels that are steeper than the term was
/// fitted on. A pixel without an angle gets NaN.
pub(crate) fn scale(planned: &AnglePlan, cosines: &[f32], gains: &mut [f32], flags: &mut [PixelFlags]) {
    for ((gain, flags), &cosine) in gains.iter_mut().zip(flags).zip(cosines) {
        *gain *= angle::multiplier(planned.exponent, f64::from(cosine)) as f32;
        let beyond = f64::from(cosine) < planned.least_cosine;
        *flags |= PixelFlags::ILLUMINATION_OUT_OF_RANGE.when(beyond);
    }
}
