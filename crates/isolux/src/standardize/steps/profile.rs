//! The step that removes the effect of the illumination profile: a factor on the multipliers of a block.

use std::ops::Range;

use crate::advice::RecordingKind;
use crate::frame::{PixelFlags, Shape};
use crate::standardize::error::StandardizeError;
use crate::standardize::planner::Planner;
use crate::standardize::report::{Note, PlanError};
use crate::step_names::{Method, ProfileStep};
use crate::terms::profile::ProfileGains;

/// Plans the step and computes the multipliers of the whole image. `best` uses the profile if the calibration holds
/// one for this shape of frames; the method `paper` uses none.
///
/// # Errors
/// [`PlanError`] when it was asked for by name and cannot be done.
pub(crate) fn plan(planner: &mut Planner<'_>) -> Result<Option<ProfileGains>, PlanError> {
    let named = planner.choice.profile == Some(ProfileStep::On);
    if planner.choice.profile == Some(ProfileStep::Off) || (!named && planner.choice.method == Method::Paper)
    {
        return Ok(None);
    }
    let held = planner.calibration.and_then(|calibration| calibration.terms.profile.as_ref());
    let Some(profile) = held else {
        return if named { Err(planner.missing("profile", RecordingKind::Target)) } else { Ok(None) };
    };
    let expected = profile.shape();
    if let Some(found) = planner.traits.shape.filter(|shape| *shape != expected) {
        if named {
            return Err(PlanError::ProfileFormat { found, expected });
        }
        planner.notes.push(Note::ProfileFormat { found, expected });
        return Ok(None);
    }
    let planned = profile.gains();
    let outside = planned.outside.iter().filter(|outside| **outside).count();
    let share = 100.0 * outside as f64 / planned.outside.len().max(1) as f64;
    let parameters = format!("{expected}, {share:.1} % of it outside the support (constant there, flagged)");
    planner.step("profile", "profile", parameters);
    Ok(Some(planned))
}

/// Refuses frames of another shape than the profile's.
///
/// # Errors
/// [`StandardizeError::ProfileFormat`].
pub(crate) fn expect_format(planned: &ProfileGains, found: Shape) -> Result<(), StandardizeError> {
    let expected = planned.gains.shape();
    if found == expected { Ok(()) } else { Err(StandardizeError::ProfileFormat { found, expected }) }
}

/// Multiplies the multipliers of these pixels, and flags those outside the support.
pub(crate) fn scale(
    planned: &ProfileGains,
    pixels: Range<usize>,
    gains: &mut [f32],
    flags: &mut [PixelFlags],
) {
    let factors = &planned.gains.values()[pixels.clone()];
    gains.iter_mut().zip(factors).for_each(|(gain, factor)| *gain *= factor);
    for (flags, &outside) in flags.iter_mut().zip(&planned.outside[pixels]) {
        *flags |= PixelFlags::ILLUMINATION_OUT_OF_RANGE.when(outside);
    }
}
