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

mod median;
mod noise;
mod plane;
mod temporal;
#[cfg(test)]
mod tests;
mod wiener;

pub use temporal::TemporalMean;

use crate::flags::PixelFlags;
use crate::frame::Frame;
use crate::plane::{Plane, Shape};
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
            Self::Plane => format!("{}, σ ∝ 1/amplitude estimated per frame", window(plane::RADIUS)),
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
    noise: NoiseScale,
    /// `σ_d² a²` of the last frame that was denoised by a rule that needs it, m² DN².
    scale: f64,
    wiener: Wiener,
    guide: plane::Guide,
}

impl Denoiser {
    /// The distances to scale by, row by row: denoised where the pixel is valid, the frame's own elsewhere.
    /// Allocates only when the shape differs from that of the last frame.
    pub(crate) fn denoise(&mut self, rule: DenoiseRule, frame: &Frame, distance_m: &Plane<f32>) -> &[f32] {
        let amplitude = frame.amplitude.values();
        self.measured_m.resize(amplitude.len(), f32::NAN);
        self.denoised_m.resize(amplitude.len(), f32::NAN);
        measured(amplitude, distance_m.values(), frame.flags.values(), &mut self.measured_m);
        let image = Image { shape: frame.shape(), distance_m: &self.measured_m, amplitude };
        let out = &mut self.denoised_m;
        match rule {
            DenoiseRule::Median => median::denoise(image, out),
            DenoiseRule::Wiener => {
                self.scale = self.noise.estimate(image);
                self.wiener.denoise(image, self.scale, out, None);
            }
            DenoiseRule::Plane => {
                self.scale = self.noise.estimate(image);
                self.guide.denoise(image, self.scale, &mut self.wiener, out);
            }
            // One frame is its own mean.
            DenoiseRule::Temporal => out.copy_from_slice(image.distance_m),
        }
        keep_the_rest(out, distance_m.values());
        out
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
