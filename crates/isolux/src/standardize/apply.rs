//! The chain applied to one frame: each step first prepares what it needs of the frame, then one loop over blocks
//! of pixels does the arithmetic of all steps.

use std::ops::Range;

use super::error::StandardizeError;
use super::kernel::{self, BLOCK, Block};
use super::plan::Plan;
use super::prepared::Prepared;
use super::standardized::{FrameSummary, Standardized};
use super::steps::denoise::scaling_distance;
use super::steps::response::{Fill, Repaired, SaturationCorrection};
use super::steps::sigma::Predictor;
use super::steps::time::TimeGain;
use super::steps::{angle, profile, specular, time};
use super::workspace::Workspace;
use crate::denoise::{DenoiseRule, Denoiser};
use crate::frame::{Frame, PixelFlags};
use crate::terms::DistanceLaw;

/// Multipliers of a step that is left out; small enough to stay in the cache.
const ONES: [f32; BLOCK] = [1.0; BLOCK];

/// One frame as the loop reads it: one value for each pixel.
struct Inputs<'a> {
    /// Corrected for saturation where the chain does that.
    amplitude: &'a [f32],
    time: TimeGain<'a>,
    /// The distances that scale the amplitude, m; `None` when no step does.
    distance_m: Option<&'a [f32]>,
    /// Cosines of the angle of incidence; `None` when no step needs them.
    cosines: Option<&'a [f32]>,
    sigma: Option<Predictor<'a>>,
}

/// Standardizes `frame` into `out`.
///
/// # Errors
/// [`StandardizeError`] when the frame lacks what the plan needs, or its planes differ in shape.
pub(super) fn apply(
    plan: &Plan,
    frame: &Frame,
    prepared: &Prepared,
    workspace: &mut Workspace,
    out: &mut Standardized,
) -> Result<(), StandardizeError> {
    frame.check_shapes()?;
    out.reshape(frame.shape(), plan.sigma.is_some());
    out.flags.values_mut().copy_from_slice(frame.flags.values());
    let flags = out.flags.values_mut();
    let Workspace { corrected, gains, signal_to_noise, denoiser, incidence, quantiles } = workspace;
    let repaired = match &plan.saturation {
        Some(correction) => {
            let fill = fill_of(correction, plan, frame, prepared, denoiser)?;
            Some(corrected.fill(correction, frame, fill, flags)?)
        }
        None => None,
    };
    let amplitude = repaired.map_or(frame.amplitude.values(), |_| corrected.amplitude());
    let own_distance_m = match repaired {
        Some(Repaired::AmplitudeAndDistance) => Some(corrected.distance_m()),
        Some(Repaired::Amplitude) | None => frame.distance_m.as_ref(),
    };
    let time = time::gains(&plan.time, frame, prepared.relative_gain, gains, flags)?;
    let law = plan.distance.as_ref();
    let mut sigma = plan
        .sigma
        .as_ref()
        .map(|plan| Predictor::new(plan, frame, amplitude, law, denoiser, signal_to_noise));
    let mut distance_m = None;
    if plan.distance.is_some() {
        let rule = plan.denoise;
        let scaling = scaling_distance(rule, frame, own_distance_m, prepared, sigma.is_some(), denoiser)?;
        sigma = sigma.map(|sigma| sigma.after_denoising(scaling.variance_left));
        distance_m = Some(scaling.distance_m);
    }
    if let Some(planned) = &plan.profile {
        profile::expect_format(planned, frame.shape())?;
    }
    let cosines = match &plan.angle {
        Some(planned) => {
            let surfaces = prepared.mean(frame.shape())?.map(|mean| &mean.distance_m).or(own_distance_m);
            let surfaces = surfaces.ok_or(StandardizeError::DistanceMissing)?;
            angle::expect_format(planned, frame.shape())?;
            Some(incidence.cosines(frame, surfaces, &planned.rays))
        }
        None => None,
    };
    scale(plan, &Inputs { amplitude, time: time.gain, distance_m, cosines, sigma }, out);
    let specular_cutoff = plan.specular.and_then(|rule| specular::limit(rule, out, quantiles));
    out.summary = FrameSummary {
        specular_cutoff,
        time_refused: time.uncovered.refused,
        time_extrapolated: time.uncovered.extrapolated,
        ..FrameSummary::of(out.flags.values())
    };
    Ok(())
}

/// What a correction by distance and ambient light needs of the frame; nothing for others.
fn fill_of<'a>(
    correction: &SaturationCorrection,
    plan: &Plan,
    frame: &'a Frame,
    prepared: &'a Prepared,
    denoiser: &'a mut Denoiser,
) -> Result<Fill<'a>, StandardizeError> {
    if !matches!(correction, SaturationCorrection::Ambient { .. }) {
        return Ok(Fill::default());
    }
    // The fill follows from the square of the distance: its noise would bias the correction.
    let rule = plan.denoise.or(Some(DenoiseRule::Wiener));
    let denoised = scaling_distance(rule, frame, frame.distance_m.as_ref(), prepared, false, denoiser)?;
    Ok(Fill { distance_m: denoised.distance_m, ambient_dn_per_us: prepared.ambient_dn_per_us })
}

/// Runs the point-wise loop block by block.
fn scale(plan: &Plan, inputs: &Inputs<'_>, out: &mut Standardized) {
    let law = plan.distance.as_ref().unwrap_or(&DistanceLaw::ONE);
    let pixels = inputs.amplitude.len();
    let varies = law.has_table()
        || plan.profile.is_some()
        || plan.angle.is_some()
        || matches!(inputs.time, TimeGain::PerPixel(_));
    let mut gains = ONES;
    for start in (0..pixels).step_by(BLOCK) {
        let block = start..(start + BLOCK).min(pixels);
        let gains = &mut gains[..block.len()];
        let distance_m = inputs.distance_m.map_or(&ONES[..block.len()], |all| &all[block.clone()]);
        let flags = &mut out.flags.values_mut()[block.clone()];
        if varies || start == 0 {
            inputs.time.write(block.clone(), gains);
        }
        law.scale(distance_m, gains);
        scale_by_illumination(plan, inputs, block.clone(), gains, flags);
        let values = &mut out.amplitude.values_mut()[block.clone()];
        let pixels = Block { amplitude: &inputs.amplitude[block.clone()], distance_m, gain: gains };
        kernel::pointwise(pixels, &law.polynomial, plan.low_signal_below_dn, values, flags);
        if let (Some(predictor), Some(sigma)) = (&inputs.sigma, &mut out.sigma) {
            predictor.predict(start, distance_m, values, &mut sigma.values_mut()[block], flags);
        }
    }
}

/// Puts profile and angle on the multipliers of a block.
fn scale_by_illumination(
    plan: &Plan,
    inputs: &Inputs<'_>,
    block: Range<usize>,
    gains: &mut [f32],
    flags: &mut [PixelFlags],
) {
    if let Some(planned) = &plan.profile {
        profile::scale(planned, block.clone(), gains, flags);
    }
    if let (Some(planned), Some(cosines)) = (&plan.angle, inputs.cosines) {
        angle::scale(planned, &cosines[block], gains, flags);
    }
}
