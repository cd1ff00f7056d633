//! Denoises a frame by the rules that need no other frame.

use super::image::{Image, keep_the_rest, measured};
use super::noise::NoiseScale;
use super::rule::DenoiseRule;
use super::wiener::Wiener;
use super::{facet, median, wiener};
use crate::frame::{Frame, Plane};
use crate::memory::bytes;

/// Working memory of the rules that need no other frame, kept between frames. Empty until it is used.
#[derive(Clone, Debug, Default)]
pub(crate) struct Denoiser {
    /// Distances, m; NaN where a pixel does not count.
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
    /// Variance of each distance over that of the delivered one, 0..=1; empty where it was not asked for.
    pub(crate) variance_left: &'a [f32],
}

impl Denoiser {
    /// Bytes that it holds.
    pub(crate) fn bytes(&self) -> usize {
        let planes = [&self.measured_m, &self.denoised_m, &self.variance_left].map(bytes);
        planes.iter().sum::<usize>() + self.noise.bytes() + self.wiener.bytes() + self.guide.bytes()
    }

    /// σ_d in m of a pixel of signal-to-noise ratio 1; that of other pixels is lower by their ratio. 0 where the
    /// frame does not determine it. `snr` holds the ratio of each pixel.
    pub(crate) fn unit_noise_m(&mut self, frame: &Frame, distance_m: &Plane<f32>, snr: &[f32]) -> f64 {
        self.measured_m.resize(snr.len(), f32::NAN);
        measured(snr, distance_m.values(), frame.flags.values(), &mut self.measured_m);
        let image = Image { shape: frame.shape(), distance_m: &self.measured_m, amplitude: snr };
        self.noise.estimate(image).sqrt()
    }

    /// The distances (m) that scale the amplitude, and, where `wanted`, how much of their variance is left.
    /// Allocates only when the shape differs from that of the last frame.
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
            // The mean over one frame is the frame itself.
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
