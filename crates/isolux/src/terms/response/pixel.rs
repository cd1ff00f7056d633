//! Tier T1b, `pixel`: a fill time for every pixel of one static scene, from its amplitudes at several times.
//!
//! `ln A_ij = e_i + ln t_j + ln f′(t_j/τ_i)`, with one softness for all pixels (methods, section 2). τ_i depends on
//! the light of that scene, ambient light included: it is valid for a fixed camera and a static scene only.

use serde::{Deserialize, Serialize};

use super::fill_time::{FillTimes, Sample};
use super::means::AmplitudeStack;
use super::still::{LEAST_SAMPLES, StillScene};
use super::well::SoftWell;
use super::{ResponseError, map_rows};
use crate::frame::Shape;
use crate::numerics::minimum::minimum;
use crate::numerics::statistics::{SIGMA_PER_MAD, median, quantile};
use crate::terms::check::{Check, ParameterError, Parameters};
use crate::terms::{FitQuality, Source, root_mean_square};

/// One well per pixel, of one scene.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PixelResponse {
    /// Softness p of every well.
    pub softness: f64,
    /// Largest fill t/τ that the fit rests on; a pixel that is fuller is refused.
    pub largest_fill: f64,
    /// Integration times of the fit, µs, shortest and longest.
    pub valid_integration_time_us: [f64; 2],
    /// τ of every pixel, µs: one string per image row, values by spaces, `-` where no compression is seen.
    #[serde(with = "map_rows")]
    pub full_well_time_us: Vec<Vec<Option<f32>>>,
    /// The recordings that it was fitted to.
    pub fitted_on: Vec<Source>,
    /// How well it fits: relative deviation of the linearised amplitudes from proportion to time.
    pub fit: FitQuality,
}

/// Pixels that determine the softness.
const SOFTNESS_PIXELS: usize = 400;

impl PixelResponse {
    /// Pixels of an image whose map still fits into a calibration file.
    pub const MOST_PIXELS: usize = 1 << 20;

    /// Fits the softness and every τ to the mean amplitudes of a still scene. Samples below `least_amplitude_dn` are
    /// left out, since the mean of a noisy amplitude is too high, and so is each pixel's falling branch. Robust:
    /// Tukey's biweight. Held-out residual: every second time of the pixels, from a fit to the others.
    ///
    /// # Errors
    /// [`ResponseError`] when the times are too few, hardly any pixel is compressed, or the image is too large.
    pub(crate) fn fit(
        stack: &AmplitudeStack,
        least_amplitude_dn: f64,
        fitted_on: Vec<Source>,
    ) -> Result<Self, ResponseError> {
        let shape = stack.shape();
        if shape.pixels() > Self::MOST_PIXELS {
            return Err(ResponseError::ImageTooLarge { pixels: shape.pixels(), most: Self::MOST_PIXELS });
        }
        let data = Fit(StillScene::new(stack, least_amplitude_dn));
        let times_us = &data.0.times_us;
        if times_us.len() < LEAST_SAMPLES {
            let found = times_us.len();
            return Err(ResponseError::TooFewTimes { found, expected: LEAST_SAMPLES });
        }
        let compressed = data.0.compressed(SOFTNESS_PIXELS);
        let limits = [SoftWell::SOFTNESS_LIMITS.start().ln(), SoftWell::SOFTNESS_LIMITS.end().ln()];
        let softness = minimum(limits, |ln_p| data.cost(&compressed, ln_p.exp())).exp();
        let times = FillTimes::new(times_us, softness);
        let sigma = data.sigma(&compressed, &times)?;
        let mut samples = Vec::new();
        let mut fills = Vec::new();
        let mut full_well_time_us = Vec::with_capacity(shape.height);
        for row in 0..shape.height {
            let tau = |column: usize| {
                data.0.series_into(row * shape.width + column, &mut samples);
                let tau = times.robust(&samples, sigma)?;
                fills.extend(samples.last().map(|last: &Sample| times_us[last.time] / tau));
                Some(four_digits(tau))
            };
            full_well_time_us.push((0..shape.width).map(tau).collect::<Vec<_>>());
        }
        // The fullest hundredth may be outliers.
        let fullest = quantile(&mut fills, 0.99).ok_or(ResponseError::NoCompression)?;
        let fit = data.quality(&compressed, &times, sigma);
        let (first, last) = (times_us[0], times_us[times_us.len() - 1]);
        Ok(Self {
            softness,
            largest_fill: fullest.min(SoftWell { softness }.fill_at_peak()),
            valid_integration_time_us: [first, last],
            full_well_time_us,
            fitted_on,
            fit,
        })
    }

    /// Height and width of the map.
    #[must_use]
    pub fn shape(&self) -> Shape {
        Shape::new(self.full_well_time_us.len(), self.full_well_time_us.first().map_or(0, Vec::len))
    }

    /// Prepared for many frames.
    pub(crate) fn planned(&self) -> PlannedPixels {
        let taus = self.full_well_time_us.iter().flatten();
        PlannedPixels {
            shape: self.shape(),
            full_well_time_us: taus.map(|tau| tau.map_or(f64::INFINITY, f64::from)).collect(),
            softness: self.softness,
            longest_time_us: self.valid_integration_time_us[1],
            largest_fill: self.largest_fill,
        }
    }
}

impl Parameters for PixelResponse {
    const NAME: &'static str = "pixel";

    fn check_at(&self, here: &Check<'_>) -> Result<(), ParameterError> {
        SoftWell { softness: self.softness }.check_at(here)?;
        let fill = self.largest_fill;
        here.at("largest_fill").require(fill > 0.0 && fill <= 2.0, fill, "a fill above 0, at most 2")?;
        let [first, last] = self.valid_integration_time_us;
        let fine = 0.0 < first && first <= last && last.is_finite();
        let found = format!("{first} to {last}");
        here.at("valid_integration_time_us").require(fine, found, "two times in µs, rising")?;
        let Shape { height, width } = self.shape();
        let map = here.at("full_well_time_us");
        let even = width > 0 && self.full_well_time_us.iter().all(|row| row.len() == width);
        map.require(even, format!("{height} rows of unlike length"), "rows of one length")?;
        let taus = self.full_well_time_us.iter().flatten().flatten();
        let impossible = taus.copied().find(|tau| !(1e-3..=1e12).contains(tau));
        let found = impossible.map_or_else(String::new, |tau| tau.to_string());
        map.require(impossible.is_none(), found, "times in µs, 1e-3 to 1e12, or `-`")
    }
}

/// τ of every pixel, prepared.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct PlannedPixels {
    pub(crate) shape: Shape,
    full_well_time_us: Vec<f64>,
    softness: f64,
    largest_fill: f64,
    longest_time_us: f64,
}

impl PlannedPixels {
    /// Saturation-corrected amplitude (DN) of pixel `index`. `None` where the fill or the time is beyond the fitted
    /// range: a pixel that did not saturate there may do so later.
    pub(crate) fn linearise(&self, index: usize, amplitude_dn: f32, time_us: f64) -> Option<f32> {
        let fill = time_us / self.full_well_time_us[index];
        if fill.is_nan() || fill > self.largest_fill || time_us > self.longest_time_us {
            return None;
        }
        let slope = SoftWell { softness: self.softness }.slope(fill);
        Some((f64::from(amplitude_dn) / slope) as f32)
    }
}

fn four_digits(value: f64) -> f32 {
    let unit = 10f64.powf(value.log10().floor() - 3.0);
    ((value / unit).round() * unit) as f32
}

struct Fit<'a>(StillScene<'a>);

impl Fit<'_> {
    /// Mean of the smaller nine tenths of the pixels' costs at this softness: a few that moved do not count.
    fn cost(&self, pixels: &[usize], softness: f64) -> f64 {
        let times = FillTimes::new(&self.0.times_us, softness);
        let mut samples = Vec::new();
        let cost = |&pixel: &usize| {
            self.0.series_into(pixel, &mut samples);
            times.best(&samples).map(|best| best.cost)
        };
        let mut costs: Vec<f64> = pixels.iter().filter_map(cost).collect();
        costs.sort_by(f64::total_cmp);
        costs.truncate((costs.len() * 9).div_ceil(10));
        costs.iter().sum::<f64>() / costs.len() as f64
    }

    /// Standard deviation of a sample of weight 1, from the median residual of the pixels.
    fn sigma(&self, pixels: &[usize], times: &FillTimes) -> Result<f64, ResponseError> {
        const LEAST_PIXELS: usize = 8;
        let mut sizes = Vec::new();
        let mut samples = Vec::new();
        for &pixel in pixels {
            self.0.series_into(pixel, &mut samples);
            let Some(best) = times.best(&samples) else { continue };
            let residuals = times.residuals(&samples, best.full_well_time_us);
            sizes.extend(samples.iter().zip(residuals).map(|(s, r)| s.weight.sqrt() * r.abs()));
        }
        let deviation = median(&mut sizes).filter(|_| pixels.len() >= LEAST_PIXELS);
        // Data without noise must not divide by nothing.
        deviation.map(|d| (SIGMA_PER_MAD * d).max(1e-6)).ok_or(ResponseError::NoCompression)
    }

    fn quality(&self, pixels: &[usize], times: &FillTimes, sigma: f64) -> FitQuality {
        let (mut points, mut residuals, mut held_out) = (0, Vec::new(), Vec::new());
        let mut samples = Vec::new();
        for &pixel in pixels {
            self.0.series_into(pixel, &mut samples);
            let Some(tau) = times.robust(&samples, sigma) else { continue };
            points += samples.len();
            residuals.extend(times.residuals(&samples, tau).into_iter().map(f64::exp_m1));
            let (rest, tested): (Vec<_>, Vec<_>) =
                samples.iter().enumerate().partition(|(index, _)| index % 2 == 0);
            let only = |part: Vec<(usize, &Sample)>| part.into_iter().map(|(_, s)| *s).collect::<Vec<_>>();
            let (rest, tested) = (only(rest), only(tested));
            let Some(tau) = times.robust(&rest, sigma) else { continue };
            let level = times.level(&rest, tau);
            let error = |s: &Sample| (s.ln_rate - times.ln_slope(s.time, tau) - level).exp_m1();
            held_out.extend(tested.iter().map(error));
        }
        let residual = root_mean_square(residuals).unwrap_or(0.0);
        FitQuality { points, residual, held_out_residual: root_mean_square(held_out) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Pixels of fill times from 12 ms on, and one that never fills.
    fn stack(softness: f64, taus: &[f64], times_us: &[f64]) -> AmplitudeStack {
        let well = SoftWell { softness };
        let mut stack = AmplitudeStack::new(Shape::new(1, taus.len()));
        for &time_us in times_us {
            let amplitude = |tau: &f64| (0.01 * time_us * well.slope(time_us / tau)) as f32;
            stack.push(time_us, taus.iter().map(amplitude));
        }
        stack
    }

    const TIMES_US: [f64; 12] = [
        200.0, 500.0, 1000.0, 2000.0, 3000.0, 4500.0, 6000.0, 8000.0, 10_000.0, 12_000.0, 15_000.0, 18_000.0,
    ];

    #[test]
    fn the_fit_recovers_its_own_model_and_leaves_the_uncompressed_alone() {
        let mut taus: Vec<f64> = (0..40).map(|i| 12_000.0 * 1.03f64.powi(i)).collect();
        taus.push(1e9);
        let found = PixelResponse::fit(&stack(5.0, &taus, &TIMES_US), 0.0, Vec::new()).unwrap();
        // f32 amplitudes and the grid of fill times (parabola between steps of 2 %) leave parts in 1e4.
        assert!((found.softness / 5.0 - 1.0).abs() < 0.01, "{}", found.softness);
        assert_eq!(found.full_well_time_us[0][40], None);
        for (tau, fitted) in taus.iter().zip(&found.full_well_time_us[0]).take(40) {
            assert!((f64::from(fitted.unwrap()) / tau - 1.0).abs() < 5e-3, "{tau} {fitted:?}");
        }
        assert!(found.fit.residual < 1e-3 && found.fit.held_out_residual.unwrap() < 2e-3, "{:?}", found.fit);
        assert!(found.check_at(&Check::of("pixel")).is_ok());
        let text = serde_json::to_string(&found).unwrap();
        assert!(text.contains(" -\""), "{text}");
        assert_eq!(serde_json::from_str::<PixelResponse>(&text).unwrap(), found);
        let planned = found.planned();
        let linear = planned.linearise(0, 1.0, 3000.0).unwrap();
        assert!((1.0..1.01).contains(&linear), "{linear}");
        assert_eq!(planned.linearise(40, 1.0, 18_000.0), Some(1.0));
        assert_eq!((planned.linearise(0, 1.0, 18_000.0), planned.linearise(0, 1.0, f64::NAN)), (None, None));
    }

    #[test]
    fn a_linear_scene_has_no_fill_times() {
        let error = PixelResponse::fit(&stack(5.0, &[1e9; 50], &TIMES_US), 0.0, Vec::new()).unwrap_err();
        assert_eq!(error, ResponseError::NoCompression);
    }

    #[test]
    fn four_digits_are_kept() {
        assert_eq!((four_digits(12_345.6), four_digits(987.649)), (12_350.0, 987.6));
    }
}
