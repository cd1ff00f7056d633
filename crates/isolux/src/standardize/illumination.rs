//! The steps that take the illumination profile and the angle of incidence out: factors on the multipliers of a block.

use super::plan::{AnglePlan, IlluminationPlan, ProfilePlan};
use super::{StandardizeError, kernel};
use crate::frame::{Frame, PixelFlags, Plane};
use crate::surface::Incidence;
use crate::terms::angle;

/// What the steps need of one frame.
pub(super) struct Illumination<'a> {
    profile: Option<&'a ProfilePlan>,
    /// The step, and the cosine of every pixel.
    angle: Option<(&'a AnglePlan, &'a [f32])>,
}

impl<'a> Illumination<'a> {
    /// Computes the angles of `frame`, seen at `distance_m` (m), where the plan needs them.
    ///
    /// # Errors
    /// [`StandardizeError`] when the frame is not of the profile's format, or has no distance.
    pub(super) fn new(
        plan: &'a IlluminationPlan,
        frame: &Frame,
        distance_m: Option<&Plane<f32>>,
        incidence: &'a mut Incidence,
    ) -> Result<Self, StandardizeError> {
        if let Some(profile) = &plan.profile {
            let expected = profile.gains.gains.shape();
            if frame.shape() != expected {
                return Err(StandardizeError::ProfileFormat { found: frame.shape(), expected });
            }
        }
        let angle = match &plan.angle {
            Some(angle) => {
                let distance_m = distance_m.ok_or(StandardizeError::DistanceMissing)?;
                Some((angle, incidence.cosines(frame, distance_m, &angle.intrinsics)))
            }
            None => None,
        };
        Ok(Self { profile: plan.profile.as_ref(), angle })
    }

    /// True when there is anything to multiply by.
    pub(super) fn is_needed(&self) -> bool {
        self.profile.is_some() || self.angle.is_some()
    }

    /// Multiplies the multipliers of the pixels from `start` on, and flags those that the terms do not cover. A pixel
    /// without an angle gets NaN.
    pub(super) fn scale(&self, start: usize, gains: &mut [f32], flags: &mut [PixelFlags]) {
        let pixels = start..start + gains.len();
        if let Some(profile) = self.profile {
            let factors = &profile.gains.gains.values()[pixels.clone()];
            gains.iter_mut().zip(factors).for_each(|(gain, factor)| *gain *= factor);
            flag(flags, &profile.gains.outside[pixels.clone()]);
        }
        if let Some((plan, cosines)) = self.angle {
            for ((gain, flags), &cosine) in gains.iter_mut().zip(flags).zip(&cosines[pixels]) {
                *gain *= angle::multiplier(plan.exponent, f64::from(cosine)) as f32;
                let beyond = f64::from(cosine) < plan.least_cosine;
                *flags |= kernel::when(beyond, PixelFlags::ILLUMINATION_OUT_OF_RANGE);
            }
        }
    }
}

fn flag(flags: &mut [PixelFlags], outside: &[bool]) {
    for (flags, &outside) in flags.iter_mut().zip(outside) {
        *flags |= kernel::when(outside, PixelFlags::ILLUMINATION_OUT_OF_RANGE);
    }
}
