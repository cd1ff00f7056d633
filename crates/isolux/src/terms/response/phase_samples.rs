//! Tier T3, `phase_samples`: every raw bin is corrected for saturation before demodulation, which corrects the
//! phase, and so the distance, too.

use serde::{Deserialize, Serialize};

use super::ResponseError;
use super::full_well::FullWell;
use super::means::{PixelMeans, PixelSeries};
use super::solve::{Model, Point, Series};
use super::well::InverseTable;
use super::well_fit::{Channel, Fitted, fit};
use crate::frame::phase::metres_per_radian;
use crate::terms::check::{Check, ParameterError, Parameters};
use crate::terms::{FitQuality, Source};

/// The well of the raw bins: `A_k = black level + W f(x_k)`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PhaseSampleResponse {
    /// The well of every bin.
    pub well: FullWell,
    /// Level at which bins clip, DN, where the sweep reached it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub clip_dn: Option<f64>,
    /// Largest bin that is inverted, DN; a pixel with a larger one is refused.
    pub largest_dn: f64,
    /// Modulation frequency, Hz; if it is known, the distance is corrected too.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub modulation_frequency_hz: Option<f64>,
    /// The recordings that it was fitted to.
    pub fitted_on: Vec<Source>,
    /// How well it fits: relative deviation of the linearised bins from proportion to time.
    pub fit: FitQuality,
}

impl PhaseSampleResponse {
    /// Fits well, softness and black level to the bins of a still scene; `pixels` spread over the image.
    ///
    /// # Errors
    /// [`ResponseError`] when the times are too few or nothing is compressed.
    pub(crate) fn fit(
        pixels: &[PixelSeries],
        modulation_frequency_hz: Option<f64>,
        fitted_on: Vec<Source>,
    ) -> Result<Self, ResponseError> {
        let Fitted { well, clip_dn, largest_dn, fit } = fit(&Bins, pixels)?;
        Ok(Self { well, clip_dn, largest_dn, modulation_frequency_hz, fitted_on, fit })
    }

    /// Prepared for many pixels.
    pub(crate) fn planned(&self) -> PlannedBins {
        PlannedBins {
            black_level_dn: self.well.black_level_dn,
            table: self.well.table(self.largest_dn),
            metres_per_radian: self.modulation_frequency_hz.map(metres_per_radian),
        }
    }
}

impl Parameters for PhaseSampleResponse {
    const NAME: &'static str = "phase_samples";

    fn check_at(&self, here: &Check<'_>) -> Result<(), ParameterError> {
        self.well.check_at(here, self.largest_dn)?;
        let frequency = self.modulation_frequency_hz.unwrap_or(1e6);
        let fine = (1e3..=1e12).contains(&frequency);
        here.at("modulation_frequency_hz").require(fine, frequency, "a frequency in Hz, 1e3 to 1e12")
    }
}

/// The inverse of every bin, prepared.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct PlannedBins {
    black_level_dn: f64,
    table: InverseTable,
    metres_per_radian: Option<f64>,
}

impl PlannedBins {
    /// Linear amplitude in DN and the metres to add to the distance, of bins in the paper's order; `None` where a bin
    /// exceeds the range.
    pub(crate) fn linearise(&self, bins_dn: [f32; 4]) -> Option<(f32, f32)> {
        let mut received = [0.0; 4];
        for (received, bin) in received.iter_mut().zip(bins_dn) {
            *received = self.table.received_dn(f64::from(bin) - self.black_level_dn)?.0;
        }
        let parts = |[a1, a2, a3, a4]: [f64; 4]| (a1 - a3, a2 - a4);
        let (cosine, sine) = parts(received);
        let amplitude = 0.5 * (cosine * cosine + sine * sine).sqrt();
        let shift_m = self.metres_per_radian.map_or(0.0, |metres| {
            let (raw_cosine, raw_sine) = parts(bins_dn.map(f64::from));
            // The angle between both phasors, which is small and does not wrap.
            let turn = sine * raw_cosine - cosine * raw_sine;
            metres * turn.atan2(cosine * raw_cosine + sine * raw_sine)
        });
        Some((amplitude as f32, shift_m as f32))
    }

    pub(crate) fn repairs_distance(&self) -> bool {
        self.metres_per_radian.is_some()
    }
}

struct Bins;

impl Model<1, 1> for Bins {
    fn predict(&self, well: &FullWell, light: &[f64; 1], time_us: f64) -> [f64; 1] {
        [well.kept_dn(light[0].exp() * time_us)]
    }
}

impl Channel<1, 1> for Bins {
    fn series(&self, pixel: &[PixelMeans], start: &FullWell, usable_dn: f64) -> Vec<Series<1, 1>> {
        (0..4).filter_map(|bin| series_of_bin(pixel, bin, start, usable_dn)).collect()
    }

    fn clipping_values(&self, pixel: &[PixelMeans]) -> Vec<(f64, f64)> {
        self.largest_values(pixel)
    }

    fn largest_values(&self, pixel: &[PixelMeans]) -> Vec<(f64, f64)> {
        let largest = |m: &PixelMeans| m.phase_samples_dn.into_iter().fold(f64::NEG_INFINITY, f64::max);
        let values = pixel.iter().map(|m| (m.integration_time_us, largest(m)));
        values.filter(|(_, y)| y.is_finite()).collect()
    }

    fn plain_values(&self, pixel: &[PixelMeans]) -> Vec<(f64, f64)> {
        let values = pixel.iter().filter(|m| !m.unusable);
        let values = values.map(|m| (m.integration_time_us, m.phase_samples_dn.iter().sum::<f64>() / 4.0));
        values.filter(|(_, y)| y.is_finite()).collect()
    }

    fn proportion(&self, well: &FullWell, light: &[f64; 1], point: &Point<1>) -> Option<f64> {
        let linear = light[0].exp() * point.time_us;
        (linear > 0.1 * well.full_well_dn).then(|| well.received_dn(point.values_dn[0]) / linear)
    }
}

fn series_of_bin(pixel: &[PixelMeans], bin: usize, start: &FullWell, usable_dn: f64) -> Option<Series<1, 1>> {
    let usable = |m: &&PixelMeans| !m.unusable && m.phase_samples_dn[bin] < usable_dn;
    let point = |m: &PixelMeans| {
        let value = m.phase_samples_dn[bin];
        Point { time_us: m.integration_time_us, values_dn: [value], sigmas: [shot_noise(start, value)] }
    };
    let points: Vec<Point<1>> = pixel.iter().filter(usable).map(point).collect();
    let guess = rate(start, points.iter().map(|p| (p.time_us, p.values_dn[0])))?;
    Some(Series { points, light: [guess.ln()] })
}

/// Shot noise of a value up to a factor, DN; at the black level that of a 1/500 of the well, for the read noise.
pub(super) fn shot_noise(well: &FullWell, value_dn: f64) -> f64 {
    ((value_dn - well.black_level_dn).max(0.0) + 0.002 * well.full_well_dn).sqrt()
}

/// Charge per µs of (time, value) pairs by their sums up to 0.9 of the well, DN/µs; `None` where there is no light.
pub(super) fn rate(well: &FullWell, values: impl Iterator<Item = (f64, f64)>) -> Option<f64> {
    let (mut charge, mut time) = (0.0, 0.0);
    for (time_us, value_dn) in values {
        if value_dn - well.black_level_dn < 0.9 * well.full_well_dn {
            charge += well.received_dn(value_dn);
            time += time_us;
        }
    }
    let rate = charge / time;
    (rate > 0.0 && rate.is_finite()).then_some(rate)
}
