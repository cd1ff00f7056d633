//! The predicted standard deviation of each standardized pixel, and the bias that the noise of the distance brings.
//!
//! With the multiplier s(d), amplitude and distance errors independent of each other (methods, sections 1 and 5):
//! `σ_A′² = s² σ_a² + (A² + σ_a²)(s′² σ_d² + ½ s″² σ_d⁴)`, and the mean is `½ A s″ σ_d²` too high, which is taken off the
//! value. All other multipliers only scale. `σ_d = c σ_a / (4π f a)`, less what denoising has taken away.
//!
//! Errors are taken for normal and the value for its own expectation, which holds from a signal-to-noise ratio of
//! about 5: below, an amplitude is Rician (too high by `σ_a²/2a`) and a phase no longer normal.

use super::kernel::BLOCK;
use super::plan::SigmaPlan;
use crate::denoise::Denoiser;
use crate::frame::{Frame, IntegrationTime, Plane, Shape};
use crate::terms::noise::AmplitudeNoise;
use crate::terms::{DistanceGain, DistanceTable};

/// Largest share of a value that is taken off it: where the noise of the distance is so large, the second order
/// means nothing any more.
const LARGEST_BIAS: f32 = 0.25;

/// What one frame's prediction rests on.
#[derive(Clone, Copy)]
pub(super) struct Predictor<'a> {
    frame: &'a Frame,
    /// As the response leaves it.
    amplitude: &'a [f32],
    light: Light<'a>,
    /// σ_d in m of a pixel of signal-to-noise ratio 1.
    unit_noise_m: f32,
    law: &'a DistanceGain,
    table: Option<&'a DistanceTable>,
    /// Share of the variance of each distance that is left; empty: all of it.
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
    /// `amplitude` is the frame's, linear where the response makes it so; `scratch` (one per pixel) is overwritten.
    pub(super) fn new(
        plan: &SigmaPlan,
        frame: &'a Frame,
        amplitude: &'a [f32],
        law: Option<(&'a DistanceGain, Option<&'a DistanceTable>)>,
        denoiser: &mut Denoiser,
        scratch: &mut [f32],
    ) -> Self {
        let light = Light::of(plan, frame, amplitude);
        let (law, table) = law.unwrap_or((&DistanceGain::ONE, None));
        let unit_noise_m = match (plan.unit_noise_m, &frame.distance_m) {
            (Some(known_m), _) => known_m,
            (None, Some(distance_m)) if *law != DistanceGain::ONE => {
                signal_to_noise(frame, amplitude, light, scratch);
                denoiser.unit_noise_m(frame, distance_m, scratch)
            }
            _ => 0.0,
        };
        let unit_noise_m = unit_noise_m as f32;
        Self { frame, amplitude, light, unit_noise_m, law, table, variance_left: &[] }
    }

    /// With the distances denoised.
    pub(super) fn after_denoising(self, variance_left: &'a [f32]) -> Self {
        Self { variance_left, ..self }
    }

    /// Writes the σ of one block, and takes the bias off its values. `start` is the block's first pixel.
    pub(super) fn predict(&self, start: usize, distance_m: &[f32], values: &mut [f32], sigma: &mut [f32]) {
        let count = values.len();
        let amplitude = &self.amplitude[start..start + count];
        let (mut noise, mut slope, mut curvature) = ([0.0; BLOCK], [0.0; BLOCK], [0.0; BLOCK]);
        self.light.variances(self.frame, start, &mut noise[..count]);
        relative_noise(amplitude, &mut noise[..count]);
        derivatives(self.law, distance_m, &mut slope[..count], &mut curvature[..count]);
        if let Some(table) = self.table {
            with_table(table, distance_m, &mut slope[..count], &mut curvature[..count]);
        }
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
fn signal_to_noise(frame: &Frame, amplitude: &[f32], light: Light<'_>, out: &mut [f32]) {
    let amplitudes = amplitude.chunks(BLOCK);
    for (index, (amplitude, out)) in amplitudes.zip(out.chunks_mut(BLOCK)).enumerate() {
        light.variances(frame, index * BLOCK, out);
        out.iter_mut().zip(amplitude).for_each(|(out, amplitude)| *out = amplitude / out.sqrt());
    }
}

/// From the variance to `σ_a²/a²`, both of the linear amplitude: shot noise is that of the light, whatever the well
/// keeps of it.
#[multiversion::multiversion(targets("x86_64+avx512f+avx512bw+avx512vl+avx512dq", "x86_64+avx2"))]
fn relative_noise(amplitude: &[f32], variance: &mut [f32]) {
    for (variance, &a) in variance.iter_mut().zip(amplitude) {
        *variance /= a * a;
    }
}

/// `s′/s` and `s″/s` of the law.
#[multiversion::multiversion(targets("x86_64+avx512f+avx512bw+avx512vl+avx512dq", "x86_64+avx2"))]
fn derivatives(law: &DistanceGain, distance_m: &[f32], slope: &mut [f32], curvature: &mut [f32]) {
    for ((&d, slope), curvature) in distance_m.iter().zip(slope).zip(curvature) {
        let [s, s1, s2] = law.derivatives(d);
        *slope = s1 / s;
        *curvature = s2 / s;
    }
}

/// The same of the law times the table: `(st)″ / st = s″/s + 2 (s′/s)(t′/t) + t″/t`.
#[multiversion::multiversion(targets("x86_64+avx512f+avx512bw+avx512vl+avx512dq", "x86_64+avx2"))]
fn with_table(table: &DistanceTable, distance_m: &[f32], slope: &mut [f32], curvature: &mut [f32]) {
    for ((&d, slope), curvature) in distance_m.iter().zip(slope).zip(curvature) {
        let [t, t1, t2] = table.derivatives(d);
        *curvature += 2.0 * *slope * (t1 / t) + t2 / t;
        *slope += t1 / t;
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
        // Comparisons that a NaN fails: what is unknown changes no value.
        let bias = if bias > LARGEST_BIAS { LARGEST_BIAS } else { bias };
        let bias = if bias < -LARGEST_BIAS { -LARGEST_BIAS } else { bias };
        let bias = if bias.is_nan() { 0.0 } else { bias };
        sigma[i] = values[i] * relative;
        values[i] -= values[i] * bias;
    }
}

/// The plane of σ, made where there is none.
pub(super) fn plane(sigma: &mut Option<Plane<f32>>, shape: Shape) -> &mut Plane<f32> {
    let plane = sigma.get_or_insert_with(|| Plane::filled(shape, f32::NAN));
    plane.reshape(shape, f32::NAN);
    plane
}

#[cfg(test)]
mod tests;
