//! The step that removes the effect of the angle of incidence: a factor on the multipliers of a block.

use crate::frame::{Channels, Lens, PixelFlags, PixelRays, Shape};
use crate::standardize::error::StandardizeError;
use crate::standardize::planner::Planner;
use crate::standardize::report::{Note, PlanError};
use crate::step_names::AngleStep;
use crate::terms::angle::{self, LAMBERT, LEAST_COSINE};

/// How a cosine becomes a multiplier.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct AnglePlan {
    exponent: f64,
    /// Cosines below this are flagged.
    least_cosine: f64,
    pub(crate) rays: PixelRays,
}

/// Plans the step; it is off unless it is asked for.
///
/// # Errors
/// [`PlanError`] when the recording lacks distance or rays.
pub(crate) fn plan(planner: &mut Planner<'_>) -> Result<Option<AnglePlan>, PlanError> {
    if planner.choice.angle != Some(AngleStep::On) {
        return Ok(None);
    }
    planner.has(Channels::DISTANCE, ["angle", "angle", "distance"], true)?;
    let rays = rays(planner.traits.lens.as_ref(), planner.traits.shape)?;
    if let Some(angle) = planner.calibration.and_then(|calibration| calibration.terms.angle.as_ref()) {
        let [least, _] = angle.valid_cosine;
        let parameters = format!(
            "cos^-{:.3}, seen down to a cosine of {least:.2} (flagged below), clamped at {LEAST_COSINE}",
            angle.exponent
        );
        planner.step("angle", "angle", parameters);
        let least_cosine = least.max(LEAST_COSINE);
        return Ok(Some(AnglePlan { exponent: angle.exponent, least_cosine, rays }));
    }
    if planner.calibration.is_some() {
        planner.notes.push(Note::Lambert);
    }
    planner.step("angle", "lambert", format!("1 / cosθ, clamped at a cosine of {LEAST_COSINE}"));
    Ok(Some(AnglePlan { exponent: LAMBERT, least_cosine: LEAST_COSINE, rays }))
}

/// The rays of all pixels, computed here once. Only a pinhole has some without knowing the shape of the frames.
fn rays(lens: Option<&Lens>, shape: Option<Shape>) -> Result<PixelRays, PlanError> {
    let lens = lens.filter(|lens| lens.is_usable()).ok_or(PlanError::IntrinsicsMissing)?;
    match (lens, shape) {
        (Lens::Pinhole(pinhole), _) => Ok(PixelRays::Pinhole(*pinhole)),
        (lens, Some(shape)) => {
            lens.check_shape(shape)?;
            Ok(lens.pixel_rays(shape))
        }
        (_, None) => Err(PlanError::LensWithoutShape),
    }
}

/// Refuses frames of another shape than that of the rays.
///
/// # Errors
/// [`StandardizeError::LensFormat`].
pub(crate) fn expect_format(planned: &AnglePlan, found: Shape) -> Result<(), StandardizeError> {
    match &planned.rays {
        PixelRays::Table(table) if table.shape() != found => {
            Err(StandardizeError::LensFormat { found, expected: table.shape() })
        }
        _ => Ok(()),
    }
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
