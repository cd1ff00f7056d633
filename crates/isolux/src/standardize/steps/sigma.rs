//! The predicted standard deviation of each standardized pixel, and the bias that the noise of the distance causes.
//!
//! With the multiplier s(d), and errors of amplitude and distance that are independent of each other (methods,
//! sections 1 and 5): `σ_A′² = s² σ_a² + (A² + σ_a²)(s′² σ_d² + ½ s″² σ_d⁴)`. The mean is too high by
//! `½ A s″ σ_d²`, which is subtracted from the value. All other multipliers only scale. `σ_d = c σ_a / (4π f a)`,
//! reduced by the denoising.
//!
//! Errors are assumed to be normal, and the value to equal its own expectation. This holds from a signal-to-noise
//! ratio of about 5 on: below, an amplitude is Rician (too high by `σ_a²/2a`) and the phase is no longer normal.

use crate::calibration::{Calibration, NoiseFloor};
use crate::denoise::Denoiser;
use crate::frame::phase::metres_per_radian;
use crate::frame::{Channels, Frame, IntegrationTime, PixelFlags};
use crate::standardize::kernel::BLOCK;
use crate::standardize::planner::Planner;
use crate::standardize::report::{Note, PlanError};
use crate::step_names::SigmaStep;
use crate::terms::noise::AmplitudeNoise;
use crate::terms::{DistanceLaw, NoiseModel};

/// What the prediction is computed from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SigmaPlan {
    pub(crate) noise: NoiseModel,
    /// σ_d in m of a pixel of signal-to-noise ratio 1; `None`: estimated from each frame.
    pub(crate) unit_noise_m: Option<f64>,
    /// Channels that it reads besides those of the other steps.
    pub(crate) needed: Channels,
}

/// Plans the prediction where the noise is known; `distance_scales` is true when a step scales by the distance.
///
/// # Errors
/// [`PlanError`] when it was asked for by name and the noise is not known or impossible.
pub(crate) fn plan(planner: &mut Planner<'_>, distance_scales: bool) -> Result<Option<SigmaPlan>, PlanError> {
    let required = match planner.choice.sigma {
        SigmaStep::None => return Ok(None),
        SigmaStep::WhereKnown => false,
        SigmaStep::Required => true,
    };
    let fitted = |calibration: &Calibration| calibration.terms.noise.as_ref().map(|noise| noise.model());
    let Some(noise) = planner.choice.noise.or(planner.calibration.and_then(fitted)) else {
        return if required { Err(PlanError::NoiseUnknown) } else { Ok(None) };
    };
    noise.check()?;
    let by_intensity = noise.by_intensity.filter(|_| planner.traits.channels.contains(Channels::INTENSITY));
    let AmplitudeNoise { ambient_variance_dn2_per_us: ambient, .. } = noise.by_amplitude;
    let needed = match by_intensity {
        Some(_) => Channels::INTENSITY,
        None if ambient > 0.0 => Channels::INTEGRATION_TIME,
        None => Channels::empty(),
    };
    if !planner.has(needed, ["sigma", "sigma", "integration time"], required)? {
        return Ok(None);
    }
    let unit_noise_m = planner.traits.modulation_frequency_hz.map(metres_per_radian);
    let light = if by_intensity.is_some() { "intensity" } else { "amplitude" };
    let distance = match (distance_scales, unit_noise_m) {
        (false, _) => "",
        (true, Some(_)) => ", that of the distance by the modulation frequency",
        (true, None) => ", that of the distance estimated per frame",
    };
    if distance_scales && unit_noise_m.is_none() {
        planner.notes.push(Note::FrequencyUnknown);
    }
    let parameters =
        format!("noise of the amplitude by the {light}{distance}; ½ s″ σ_d² taken off the value");
    planner.step("sigma", "noise", parameters);
    Ok(Some(SigmaPlan { noise: NoiseModel { by_intensity, ..noise }, unit_noise_m, needed }))
}

/// Largest share of a value that is subtracted as bias: where the noise of the distance is larger, the second-order
/// formula is not valid.
const LARGEST_BIAS: f32 = 0.25;

/// What the prediction for one frame is computed from.
#[derive(Clone, Copy)]
pub(crate) struct Predictor<'a> {
    frame: &'a Frame,
    /// Saturation-corrected where the chain does that.
    amplitude: &'a [f32],
    light: Light<'a>,
    /// σ_d in m of a pixel of signal-to-noise ratio 1.
    unit_noise_m: f32,
    law: &'a DistanceLaw,
    /// Variance of each distance over that of the delivered one; empty when nothing was denoised.
    variance_left: &'a [f32],
}

/// Variance of the amplitude, DN²: a constant, a multiple of the light, a multiple of the integration time.
#[derive(Clone, Copy)]
struct Light<'a> {
    read: f32,
    shot: f32,
    ambient: f32,
    dn: &'a [f32],
}

impl<'a> Light<'a> {
    fn of(plan: &SigmaPlan, frame: &'a Frame, amplitude: &'a [f32]) -> Self {
        if let (Some(noise), Some(intensity)) = (plan.noise.by_intensity, &frame.intensity) {
            let (read, shot) = (noise.read_variance_dn2 as f32, noise.shot_variance_dn2_per_dn as f32);
            return Self { read, shot, ambient: 0.0, dn: intensity.values() };
        }
        let AmplitudeNoise { read_variance_dn2, shot_variance_dn2_per_dn, ambient_variance_dn2_per_us } =
            plan.noise.by_amplitude;
        Self {
            read: read_variance_dn2 as f32,
            shot: shot_variance_dn2_per_dn as f32,
            ambient: ambient_variance_dn2_per_us as f32,
            dn: amplitude,
        }
    }

    /// Variances from pixel `start` on; NaN where the ambient light needs a time that is unknown.
    fn variances(&self, frame: &Frame, start: usize, out: &mut [f32]) {
        let count = out.len();
        match &frame.integration_time_us {
            _ if self.ambient == 0.0 => out.fill(self.read),
            IntegrationTime::Unknown => out.fill(f32::NAN),
            IntegrationTime::PerFrame(time_us) => out.fill(self.read + self.ambient * *time_us as f32),
            IntegrationTime::PerPixel(map) => {
                let times = &map.values()[start..start + count];
                out.iter_mut()
                    .zip(times)
                    .for_each(|(out, time_us)| *out = self.read + self.ambient * time_us);
            }
        }
        shot(&self.dn[start..start + count], self.shot, out);
    }
}

#[multiversion::multiversion(targets("x86_64+avx512f+avx512bw+avx512vl+avx512dq", "x86_64+avx2"))]
fn shot(light_dn: &[f32], per_dn: f32, variance: &mut [f32]) {
    for (variance, &light) in variance.iter_mut().zip(light_dn) {
        // No light below the black level; NaN stays.
        let light = if light < 0.0 { 0.0 } else { light };
        *variance += per_dn * light;
    }
}

impl<'a> Predictor<'a> {
    /// `amplitude` is the frame's, corrected for saturation where the response does that; `law` that of the distance
    /// step; `signal_to_noise` is memory for the estimate of the distance's noise.
    pub(crate) fn new(
        plan: &SigmaPlan,
        frame: &'a Frame,
        amplitude: &'a [f32],
        law: Option<&'a DistanceLaw>,
        denoiser: &mut Denoiser,
        signal_to_noise: &mut Vec<f32>,
    ) -> Self {
        let light = Light::of(plan, frame, amplitude);
        let unit_noise_m = match (plan.unit_noise_m, &frame.distance_m) {
            (Some(known_m), _) => known_m,
            (None, Some(distance_m)) if law.is_some() => {
                signal_to_noise.resize(amplitude.len(), f32::NAN);
                fill_signal_to_noise(frame, amplitude, light, signal_to_noise);
                denoiser.unit_noise_m(frame, distance_m, signal_to_noise)
            }
            _ => 0.0,
        };
        let (unit_noise_m, law) = (unit_noise_m as f32, law.unwrap_or(&DistanceLaw::ONE));
        Self { frame, amplitude, light, unit_noise_m, law, variance_left: &[] }
    }

    /// With the distances denoised.
    pub(crate) fn after_denoising(self, variance_left: &'a [f32]) -> Self {
        Self { variance_left, ..self }
    }

    /// Writes the σ of one block, subtracts the bias from its values, and flags those of low signal. `start` is the
    /// block's first pixel.
    pub(crate) fn predict(
        &self,
        start: usize,
        distance_m: &[f32],
        values: &mut [f32],
        sigma: &mut [f32],
        flags: &mut [PixelFlags],
    ) {
        let count = values.len();
        let amplitude = &self.amplitude[start..start + count];
        let (mut noise, mut slope, mut curvature) = ([0.0; BLOCK], [0.0; BLOCK], [0.0; BLOCK]);
        self.light.variances(self.frame, start, &mut noise[..count]);
        relative_noise(amplitude, &mut noise[..count]);
        flag_low_signal(&noise[..count], flags);
        self.law.relative_derivatives(distance_m, &mut slope[..count], &mut curvature[..count]);
        let mut distance_variance = [self.unit_noise_m * self.unit_noise_m; BLOCK];
        if let Some(left) = self.variance_left.get(start..start + count) {
            distance_variance.iter_mut().zip(left).for_each(|(variance, left)| *variance *= left);
        }
        let block = Propagated {
            noise: &noise[..count],
            slope: &slope[..count],
            curvature: &curvature[..count],
            distance_variance: &distance_variance[..count],
        };
        propagate(block, values, sigma);
    }
}

/// a/σ_a of every pixel.
fn fill_signal_to_noise(frame: &Frame, amplitude: &[f32], light: Light<'_>, out: &mut [f32]) {
    let amplitudes = amplitude.chunks(BLOCK);
    for (index, (amplitude, out)) in amplitudes.zip(out.chunks_mut(BLOCK)).enumerate() {
        light.variances(frame, index * BLOCK, out);
        out.iter_mut().zip(amplitude).for_each(|(out, amplitude)| *out = amplitude / out.sqrt());
    }
}

/// Turns the variance into `σ_a²/a²`, both of the linear amplitude: shot noise follows from the light, not from the
/// saturated amplitude.
#[multiversion::multiversion(targets("x86_64+avx512f+avx512bw+avx512vl+avx512dq", "x86_64+avx2"))]
fn relative_noise(amplitude: &[f32], variance: &mut [f32]) {
    for (variance, &a) in variance.iter_mut().zip(amplitude) {
        *variance /= a * a;
    }
}

/// Flags the pixels whose amplitude is less than [`NoiseFloor::LOW_SIGNAL_SNR`] times its noise. `noise` is σ_a²/a².
#[multiversion::multiversion(targets("x86_64+avx512f+avx512bw+avx512vl+avx512dq", "x86_64+avx2"))]
fn flag_low_signal(noise: &[f32], flags: &mut [PixelFlags]) {
    let most = (1.0 / (NoiseFloor::LOW_SIGNAL_SNR * NoiseFloor::LOW_SIGNAL_SNR)) as f32;
    for (flags, &noise) in flags.iter_mut().zip(noise) {
        let low = (noise > most) & !flags.contains(PixelFlags::INVALID);
        *flags |= PixelFlags::LOW_SIGNAL.when(low);
    }
}

/// One block; all slices have the same length.
#[derive(Clone, Copy)]
struct Propagated<'a> {
    /// σ_a²/a².
    noise: &'a [f32],
    /// s′/s, per m.
    slope: &'a [f32],
    /// s″/s, per m².
    curvature: &'a [f32],
    /// σ_d² of a pixel of signal-to-noise ratio 1, m².
    distance_variance: &'a [f32],
}

#[multiversion::multiversion(targets("x86_64+avx512f+avx512bw+avx512vl+avx512dq", "x86_64+avx2"))]
fn propagate(block: Propagated<'_>, values: &mut [f32], sigma: &mut [f32]) {
    let count = values.len();
    let (noise, slope, curvature) = (&block.noise[..count], &block.slope[..count], &block.curvature[..count]);
    let (distance_variance, sigma) = (&block.distance_variance[..count], &mut sigma[..count]);
    for i in 0..count {
        let distance = distance_variance[i] * noise[i];
        let bias = 0.5 * curvature[i] * distance;
        let port = slope[i] * slope[i] * distance + 2.0 * bias * bias;
        let relative = (noise[i] + (1.0 + noise[i]) * port).sqrt();
        // NaN fails both comparisons: an unknown bias changes no value.
        let bias = if bias > LARGEST_BIAS { LARGEST_BIAS } else { bias };
        let bias = if bias < -LARGEST_BIAS { -LARGEST_BIAS } else { bias };
        let bias = if bias.is_nan() { 0.0 } else { bias };
        sigma[i] = values[i] * relative;
        values[i] -= values[i] * bias;
    }
}

#[cfg(test)]
#[path = "sigma_tests.rs"]
mod tests;
