//! Tier T2, `intensity`: the DC image shows how full the well is, whatever the light.
//!
//! `A_lin = A / f′(f⁻¹(O))`, O the intensity, is valid for a small modulation only: with a contrast of 0.5 it is 4
//! % off at a fill of 0.8 and 15 % near the clip, because the highest bin saturates far more than the mean.
//! Intensity and amplitude together are the four bins but for one number: with the phase at π/8 (that of the mean
//! 4φ ripple; the ripple itself is at most 2–5 %), `A_k = O + A cos(φ − kπ/2) ± e`, and e is what makes the
//! inverted bins a cosine again, `x_1 + x_3 = x_2 + x_4`. Where the phase is known from the distance, this is
//! exactly the tier of the raw bins.

use std::f64::consts::FRAC_PI_8;

use serde::{Deserialize, Serialize};

use super::ResponseError;
use super::bins::bins;
use super::full_well::FullWell;
use super::means::{PixelMeans, PixelSeries};
use super::phase_samples::{rate, shot_noise};
use super::solve::{Model, Point, Series};
use super::well::InverseTable;
use super::well_fit::{Channel, Fitted, fit};
use crate::terms::check::{Check, ParameterError, Parameters};
use crate::terms::{FitQuality, Source};

/// The full well, fitted to intensity and amplitude.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct IntensityResponse {
    /// The well; its black level is that of the DC image.
    pub well: FullWell,
    /// Level at which bins clip, DN, where the sweep reached it: the intensity of a pixel that is clipped altogether.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub clip_dn: Option<f64>,
    /// Largest intensity plus amplitude that is inverted, DN; a pixel above is refused.
    pub largest_dn: f64,
    /// The recordings that it was fitted to.
    pub fitted_on: Vec<Source>,
    /// How well it fits: relative deviation of the linearised amplitudes from proportion to time.
    pub fit: FitQuality,
}

impl IntensityResponse {
    /// Fits well, softness and black level to intensity and amplitude of a still scene; `pixels` spread over the image.
    ///
    /// # Errors
    /// [`ResponseError`] when the times are too few or nothing is compressed.
    pub(crate) fn fit(pixels: &[PixelSeries], fitted_on: Vec<Source>) -> Result<Self, ResponseError> {
        let Fitted { well, clip_dn, largest_dn, fit } = fit(&Dc, pixels)?;
        Ok(Self { well, clip_dn, largest_dn, fitted_on, fit })
    }

    /// Prepared for many pixels.
    pub(crate) fn planned(&self) -> PlannedIntensity {
        let most = self.well.largest_dn(None).max(self.largest_dn);
        PlannedIntensity {
            black_level_dn: self.well.black_level_dn,
            largest_dn: self.largest_dn - self.well.black_level_dn,
            table: self.well.table(most),
        }
    }
}

impl Parameters for IntensityResponse {
    const NAME: &'static str = "intensity";

    fn check_at(&self, here: &Check<'_>) -> Result<(), ParameterError> {
        self.well.check_at(here, self.largest_dn)
    }
}

/// The inverse, prepared.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct PlannedIntensity {
    black_level_dn: f64,
    largest_dn: f64,
    table: InverseTable,
}

/// Steps of Newton's method for e. It converges from one side, because the inverse well is convex.
const STEPS: usize = 8;

impl PlannedIntensity {
    /// Linear amplitude of a pixel in DN; `None` above the range.
    pub(crate) fn linearise(&self, intensity_dn: f32, amplitude_dn: f32) -> Option<f32> {
        let (intensity, amplitude) = (f64::from(intensity_dn) - self.black_level_dn, f64::from(amplitude_dn));
        let highest = intensity + amplitude;
        if highest.is_nan() || highest > self.largest_dn {
            return None;
        }
        let bins = bins(intensity, amplitude, FRAC_PI_8);
        let mut ripple = 0.0;
        let mut received = [0.0; 4];
        for _ in 0..STEPS {
            let mut slopes = 0.0;
            let mut excess = 0.0;
            for (k, (received, bin)) in received.iter_mut().zip(bins).enumerate() {
                let sign = if k % 2 == 0 { 1.0 } else { -1.0 };
                let kept = (bin + sign * ripple).min(self.table.largest_kept_dn() * (1.0 - 1e-9));
                let (value, slope) = self.table.received_dn(kept)?;
                *received = value;
                excess += sign * value;
                slopes += slope;
            }
            if excess.abs() < 1e-5 * amplitude {
                break;
            }
            ripple -= excess / slopes;
        }
        let [a1, a2, a3, a4] = received;
        let (cosine, sine) = (a1 - a3, a2 - a4);
        Some((0.5 * (cosine * cosine + sine * sine).sqrt()) as f32)
    }
}

struct Dc;

/// Light: logarithms of the charge per µs, and of the contrast.
impl Model<2, 2> for Dc {
    fn predict(&self, well: &FullWell, light: &[f64; 2], time_us: f64) -> [f64; 2] {
        let charge = light[0].exp() * time_us;
        let kept = bins(charge, charge * light[1].exp(), FRAC_PI_8).map(|bin| well.kept_dn(bin));
        let (cosine, sine) = (kept[0] - kept[2], kept[1] - kept[3]);
        [0.25 * kept.iter().sum::<f64>(), 0.5 * (cosine * cosine + sine * sine).sqrt()]
    }
}

impl Channel<2, 2> for Dc {
    fn series(&self, pixel: &[PixelMeans], start: &FullWell, usable_dn: f64) -> Vec<Series<2, 2>> {
        let usable = |m: &&PixelMeans| !m.unusable && m.intensity_dn + m.amplitude_dn < usable_dn;
        let point = |m: &PixelMeans| {
            // The mean of four bins, and the half difference of two pairs.
            let noise = shot_noise(start, m.intensity_dn);
            let sigmas = [0.5 * noise, std::f64::consts::FRAC_1_SQRT_2 * noise];
            Point { time_us: m.integration_time_us, values_dn: [m.intensity_dn, m.amplitude_dn], sigmas }
        };
        let points: Vec<Point<2>> = pixel.iter().filter(usable).map(point).collect();
        let Some(guess) = rate(start, points.iter().map(|p| (p.time_us, p.values_dn[0]))) else {
            return Vec::new();
        };
        let contrast = |p: &Point<2>| p.values_dn[1] / (p.values_dn[0] - start.black_level_dn);
        let mut contrasts: Vec<f64> = points.iter().map(contrast).filter(|c| *c > 0.0).collect();
        let Some(contrast) = crate::numerics::statistics::median(&mut contrasts) else { return Vec::new() };
        vec![Series { points, light: [guess.ln(), contrast.min(1.0).ln()] }]
    }

    fn clipping_values(&self, pixel: &[PixelMeans]) -> Vec<(f64, f64)> {
        // Intensity plus amplitude falls back to the clip level while the amplitude collapses.
        let values = pixel.iter().map(|m| (m.integration_time_us, m.intensity_dn));
        values.filter(|(_, y)| y.is_finite()).collect()
    }

    fn largest_values(&self, pixel: &[PixelMeans]) -> Vec<(f64, f64)> {
        let values = pixel.iter().map(|m| (m.integration_time_us, m.intensity_dn + m.amplitude_dn));
        values.filter(|(_, y)| y.is_finite()).collect()
    }

    fn plain_values(&self, pixel: &[PixelMeans]) -> Vec<(f64, f64)> {
        let values = pixel.iter().filter(|m| !m.unusable).map(|m| (m.integration_time_us, m.intensity_dn));
        values.filter(|(_, y)| y.is_finite()).collect()
    }

    fn proportion(&self, well: &FullWell, light: &[f64; 2], point: &Point<2>) -> Option<f64> {
        let linear = light[0].exp() * point.time_us;
        let predicted = self.predict(well, light, point.time_us)[1];
        (linear > 0.1 * well.full_well_dn).then(|| point.values_dn[1] / predicted)
    }
}
