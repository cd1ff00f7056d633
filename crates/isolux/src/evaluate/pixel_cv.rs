//! Per-pixel coefficient of variation over integration times: what a still pixel changes with the exposure.

use serde::Serialize;

use crate::frame::Plane;
use crate::numerics::statistics::{median, quantile};

use super::fraction::fraction;
use super::input::Times;
use super::outcome::{Outcome, Unavailable};
use super::runs::Runs;

/// Coefficient of variation of each pixel over integration times, and its distribution over the image.
///
/// Population standard deviation over mean of the pixel's run means: the recorded exposures are all that is
/// compared, not a sample of others. A pixel enters when it is valid at two different times at least. Where each
/// pixel has an integration time of its own, its runs are those of its own time; a time that never changes at
/// a pixel leaves that pixel out.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PixelCv {
    /// Median over pixels, dimensionless (0.01 = 1 %).
    pub median: f64,
    /// 95 % quantile over pixels, dimensionless.
    pub p95: f64,
    /// Pixels that entered.
    pub pixels: usize,
    /// Values that entered / values of all frames, 0..=1.
    pub valid_fraction: f64,
}

/// The pixels whose signal-to-noise ratio lies in one range.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct SnrStratum {
    /// Lower end of the range, included, dimensionless.
    pub snr_from: f64,
    /// Upper end, excluded; none for the last.
    pub snr_to: Option<f64>,
    /// Median of the pixels' coefficient of variation, dimensionless; none without pixels.
    pub median_cv: Option<f64>,
    /// Pixels that entered.
    pub pixels: usize,
}

/// Collects the runs of every pixel: constant memory per pixel.
#[derive(Clone, Debug)]
pub(super) struct PixelRuns {
    runs: Vec<Runs>,
    same_time_ratio: f64,
}

impl PixelRuns {
    pub(super) fn new(pixels: usize, same_time_ratio: f64) -> Self {
        Self { runs: vec![Runs::default(); pixels], same_time_ratio }
    }

    pub(super) fn push(&mut self, usable: &[f32], times: Times<'_>) {
        for (index, (runs, &value)) in self.runs.iter_mut().zip(usable).enumerate() {
            let time_us = times.at(index);
            if !value.is_nan() && time_us > 0.0 {
                runs.push(f64::from(value), time_us, self.same_time_ratio);
            }
        }
    }

    /// Mean over the runs of each pixel, in the unit of the values.
    pub(super) fn means(&self) -> impl Iterator<Item = Option<f64>> {
        self.runs.iter().map(|runs| runs.moments().mean())
    }

    pub(super) fn finish(&self, frames: u64) -> Outcome<PixelCv> {
        let mut observations = 0;
        let mut values = Vec::new();
        for runs in &self.runs {
            if let Some(value) = runs.coefficient_of_variation() {
                values.push(value);
                observations += u64::from(runs.observations());
            }
        }
        let reason = Unavailable::NoPixelAtTwoTimes;
        Ok(PixelCv {
            median: median(&mut values).ok_or(reason)?,
            p95: quantile(&mut values, 0.95).ok_or(reason)?,
            pixels: values.len(),
            valid_fraction: fraction(observations, frames * self.runs.len() as u64),
        })
    }

    /// The median CV of the pixels between consecutive `edges` of `snr`, below the first and above the last.
    /// Pixels whose ratio is unknown (NaN) are in no stratum.
    pub(super) fn strata(&self, snr: &Plane<f32>, edges: &[f64]) -> Vec<SnrStratum> {
        let starts = std::iter::once(0.0).chain(edges.iter().copied());
        let ends = edges.iter().copied().map(Some).chain(std::iter::once(None));
        let stratum = |(snr_from, snr_to): (f64, Option<f64>)| {
            let within = |snr: f64| snr >= snr_from && snr_to.is_none_or(|end| snr < end);
            let members = self.runs.iter().zip(snr.values()).filter(|(_, snr)| within(f64::from(**snr)));
            let mut values: Vec<f64> =
                members.filter_map(|(runs, _)| runs.coefficient_of_variation()).collect();
            SnrStratum { snr_from, snr_to, median_cv: median(&mut values), pixels: values.len() }
        };
        starts.zip(ends).map(stratum).collect()
    }
}
