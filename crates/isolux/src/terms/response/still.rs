//! A still scene at several times, as the fits by amplitude use it.

use super::fill_time::Sample;
use super::means::{AmplitudeStack, rising};
use crate::numerics::statistics::median;

/// Samples of a pixel that a fit needs.
pub(super) const LEAST_SAMPLES: usize = 4;

/// The stack in the order of time, and which of it is used.
pub(super) struct StillScene<'a> {
    stack: &'a AmplitudeStack,
    order: Vec<usize>,
    /// In the order of time, µs.
    pub(super) times_us: Vec<f64>,
    least_amplitude_dn: f64,
}

impl<'a> StillScene<'a> {
    pub(super) fn new(stack: &'a AmplitudeStack, least_amplitude_dn: f64) -> Self {
        let order = stack.order();
        let times_us = order.iter().map(|&index| stack.integration_time_us()[index]).collect();
        Self { stack, order, times_us, least_amplitude_dn }
    }

    /// The samples of a pixel on its rising branch. Those of long times count more: their noise is relatively smaller.
    pub(super) fn series_into(&self, pixel: usize, out: &mut Vec<Sample>) {
        out.clear();
        let longest = self.times_us[self.times_us.len() - 1];
        let mut series = Vec::with_capacity(self.order.len());
        for (time, &image) in self.order.iter().enumerate() {
            let amplitude = self.stack.at(image, pixel);
            if amplitude > self.least_amplitude_dn && amplitude.is_finite() {
                series.push((time, amplitude));
            }
        }
        let curve: Vec<(f64, f64)> = series.iter().map(|(time, a)| (self.times_us[*time], *a)).collect();
        let rising = rising(&curve);
        out.extend(series[..rising].iter().map(|&(time, amplitude)| Sample {
            time,
            ln_rate: (amplitude / self.times_us[time]).ln(),
            weight: self.times_us[time] / longest,
        }));
    }

    /// Pixels whose amplitude falls behind the time by 3 % or more, at most `most` of them, spread over the image.
    pub(super) fn compressed(&self, most: usize) -> Vec<usize> {
        const BEHIND: f64 = 0.03;
        let mut samples = Vec::new();
        let mut found = Vec::new();
        for pixel in 0..self.stack.shape().pixels() {
            self.series_into(pixel, &mut samples);
            let mut rates: Vec<f64> = samples.iter().map(|s| s.ln_rate).collect();
            let last = rates.last().copied().unwrap_or(f64::NAN);
            let behind = median(&mut rates).is_some_and(|usual| usual - last > BEHIND);
            if behind && samples.len() >= LEAST_SAMPLES {
                found.push(pixel);
            }
        }
        let step = found.len().div_ceil(most).max(1);
        found.into_iter().step_by(step).collect()
    }
}
