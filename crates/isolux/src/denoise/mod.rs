//! Less noise in the distance before it scales the amplitude.
//!
//! A step like d² carries the distance's noise into the standardized amplitude. The rules here smooth the distance
//! that scales, and nothing else: a frame's own distance stays as it is. Pixels without a measurement neither give
//! nor take; the amplitude decides how much a distance is trusted, never where an edge is, so that its texture is
//! not copied. Distances must be unwrapped.
//!
//! | rule | window | what it is for |
//! |---|---|---|
//! | [`DenoiseRule::Median`] | 3×3 | needs no noise model |
//! | [`DenoiseRule::Wiener`] | 5×5 | real time |
//! | [`DenoiseRule::Plane`] | 7×7 | quality, slanted surfaces |
//! | [`DenoiseRule::Temporal`] | 8 frames | still scenes; see [`TemporalMean`] |

mod facet;
mod median;
mod noise;
mod temporal;
#[cfg(test)]
mod tests;
mod wiener;

pub use temporal::TemporalMean;

use crate::frame::{Frame, PixelFlags, Plane, Shape};
use noise::NoiseScale;
use wiener::Wiener;

/// How the distance is denoised.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum DenoiseRule {
    /// Median of the valid distances of 3×3 pixels.
    Median,
    /// Variance-weighted local Wiener filter of 5×5 pixels.
    Wiener,
    /// Plane fits in 7×7 pixels to the surface of the middle one.
    Plane,
    /// Mean of the last frames of a still scene.
    Temporal,
}

impl DenoiseRule {
    /// Name on the command line and in recordings.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Median => "median",
            Self::Wiener => "wiener",
            Self::Plane => "plane",
            Self::Temporal => "temporal",
        }
    }

    /// The rule's parameters in words, for the record of applied steps.
    #[must_use]
    pub fn parameters(self) -> String {
        let window = |radius: usize| format!("{0}×{0} pixels", 2 * radius + 1);
        match self {
            Self::Median => window(median::RADIUS),
            Self::Wiener => format!("{}, σ ∝ 1/amplitude estimated per frame", window(wiener::RADIUS)),
            Self::Plane => format!("{}, σ ∝ 1/amplitude estimated per frame", window(facet::RADIUS)),
            Self::Temporal => format!("last {} frames, weighted by amplitude²", TemporalMean::FRAMES),
        }
    }
}

/// One frame's distances and amplitudes. A distance is NaN where the pixel takes no part.
#[derive(Clone, Copy)]
struct Image<'a> {
    shape: Shape,
    distance_m: &'a [f32],
    amplitude: &'a [f32],
}

/// Working memory of the rules that need one frame alone, kept between frames. Empty until it is used.
#[derive(Clone, Debug, Default)]
pub(crate) struct Denoiser {
    /// NaN where a pixel takes no part.
    measured_m: Vec<f32>,
    denoised_m: Vec<f32>,
    variance_left: Vec<f32>,
    noise: NoiseScale,
    /// `σ_d² a²` of the last frame that was denoised by a rule that needs it, m² DN².
    scale: f64,
    wiener: Wiener,
    guide: facet::Guide,
}

/// A frame's distances after denoising.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Denoised<'a> {
    /// Metres, row by row: denoised where the pixel is valid, the frame's own elsewhere.
    pub(crate) distance_m: &'a [f32],
    /// Share of the variance of each delivered distance that is left, 0..=1; empty where it was not asked for.
    pub(crate) variance_left: &'a [f32],
}

impl Denoiser {
    /// σ_d in m of a pixel of signal-to-noise ratio 1, which falls as 1/ratio; 0 where the frame does not tell it.
    /// `snr` holds the ratio of each pixel.
    pub(crate) fn unit_noise_m(&mut self, frame: &Frame, distance_m: &Plane<f32>, snr: &[f32]) -> f64 {
        self.measured_m.resize(snr.len(), f32::NAN);
        measured(snr, distance_m.values(), frame.flags.values(), &mut self.measured_m);
        let image = Image { shape: frame.shape(), distance_m: &self.measured_m, amplitude: snr };
        self.noise.estimate(image).sqrt()
    }

    /// The distances to scale by, and, where `wanted`, how much of their noise is left. Allocates only when the shape
    /// differs from that of the last frame.
    pub(crate) fn denoise(
        &mut self,
        rule: DenoiseRule,
        frame: &Frame,
        distance_m: &Plane<f32>,
        wanted: bool,
    ) -> Denoised<'_> {
        let amplitude = frame.amplitude.values();
        self.measured_m.resize(amplitude.len(), f32::NAN);
        self.denoised_m.resize(amplitude.len(), f32::NAN);
        measured(amplitude, distance_m.values(), frame.flags.values(), &mut self.measured_m);
        let image = Image { shape: frame.shape(), distance_m: &self.measured_m, amplitude };
        let out = &mut self.denoised_m;
        self.variance_left.resize(if wanted { amplitude.len() } else { 0 }, 1.0);
        let left = wanted.then_some(self.variance_left.as_mut_slice());
        match rule {
            DenoiseRule::Median => {
                median::denoise(image, out);
                if let Some(left) = left {
                    left.fill(median::VARIANCE_LEFT);
                }
            }
            DenoiseRule::Wiener => {
                self.scale = self.noise.estimate(image);
                match left {
                    Some(left) => {
                        self.wiener.denoise(image, self.scale, out, Some(&mut *left));
                        left.iter_mut().for_each(|left| *left = wiener::variance_left(*left));
                    }
                    None => self.wiener.denoise(image, self.scale, out, None),
                }
            }
            DenoiseRule::Plane => {
                self.scale = self.noise.estimate(image);
                self.guide.denoise(image, self.scale, &mut self.wiener, out, left);
            }
            // One frame is its own mean.
            DenoiseRule::Temporal => {
                out.copy_from_slice(image.distance_m);
                if let Some(left) = left {
                    left.fill(1.0);
                }
            }
        }
        keep_the_rest(out, distance_m.values());
        Denoised { distance_m: out, variance_left: &self.variance_left }
    }

    /// What the last [`Self::denoise`] by [`DenoiseRule::Wiener`] gave, and `σ_d² a²` (m² DN²) of the distances
    /// before it.
    pub(crate) fn wiener_result(&self) -> (&[f32], f64) {
        (&self.denoised_m, self.scale)
    }
}

/// The distances of the pixels that may take part, NaN elsewhere.
fn measured(amplitude: &[f32], distance_m: &[f32], flags: &[PixelFlags], out: &mut [f32]) {
    for (((out, &d), &a), flags) in out.iter_mut().zip(distance_m).zip(amplitude).zip(flags) {
        let positive = (d > 0.0) & (d < f32::INFINITY) & (a > 0.0) & (a < f32::INFINITY);
        *out = if positive & !flags.contains(PixelFlags::INVALID) { d } else { f32::NAN };
    }
}

/// Pixels that took no part keep what was delivered.
fn keep_the_rest(out: &mut [f32], distance_m: &[f32]) {
    for (out, &delivered) in out.iter_mut().zip(distance_m) {
        *out = if out.is_nan() { delivered } else { *out };
    }
}
