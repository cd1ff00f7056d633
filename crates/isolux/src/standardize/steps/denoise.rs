//! The step that denoises the distance before it scales the amplitude.

use crate::choice::DenoiseStep;
use crate::denoise::{DenoiseRule, Denoiser};
use crate::frame::{Frame, Plane};
use crate::standardize::error::StandardizeError;
use crate::standardize::planner::Planner;
use crate::standardize::prepared::Prepared;
use crate::standardize::report::Note;

/// Plans the step; `distance_scales` is true when a step follows that scales by the distance.
pub(crate) fn plan(planner: &mut Planner<'_>, distance_scales: bool) -> Option<DenoiseRule> {
    let Some(DenoiseStep::Smooth(rule)) = planner.choice.denoise else { return None };
    if !distance_scales {
        planner.notes.push(Note::NothingToDenoise);
        return None;
    }
    planner.step("denoise", rule.name(), rule.parameters());
    Some(rule)
}

/// The distances that scale the amplitude.
#[derive(Clone, Copy)]
pub(crate) struct ScalingDistance<'a> {
    /// Metres, one for each pixel.
    pub(crate) distance_m: &'a [f32],
    /// Variance of each distance over that of the delivered one, 0..=1; empty when nothing was denoised.
    pub(crate) variance_left: &'a [f32],
}

/// The mean over the last frames where `prepared` has one, else the frame's own distance, denoised by the rule.
/// `variance_left` is computed only if `noise_wanted`.
///
/// # Errors
/// [`StandardizeError::DistanceMissing`] when the frame has none.
pub(crate) fn scaling_distance<'a>(
    rule: Option<DenoiseRule>,
    frame: &Frame,
    own_distance_m: Option<&'a Plane<f32>>,
    prepared: &'a Prepared,
    noise_wanted: bool,
    denoiser: &'a mut Denoiser,
) -> Result<ScalingDistance<'a>, StandardizeError> {
    if let Some(mean) = prepared.mean(frame.shape())? {
        let (distance_m, variance_left) = (mean.distance_m.values(), mean.variance_left.values());
        return Ok(ScalingDistance { distance_m, variance_left });
    }
    let delivered_m = own_distance_m.ok_or(StandardizeError::DistanceMissing)?;
    let Some(rule) = rule else {
        return Ok(ScalingDistance { distance_m: delivered_m.values(), variance_left: &[] });
    };
    let denoised = denoiser.denoise(rule, frame, delivered_m, noise_wanted);
    Ok(ScalingDistance { distance_m: denoised.distance_m, variance_left: denoised.variance_left })
}
