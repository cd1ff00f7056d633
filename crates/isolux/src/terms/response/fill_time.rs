//! The fill time of one pixel: least squares over a grid that all pixels share.

use super::well::SoftWell;
use crate::numerics::robust::{biweight, tukey_share};

/// The amplitude of one pixel at one time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Sample {
    /// Which of the times.
    pub(super) time: usize,
    /// ln (A/t).
    pub(super) ln_rate: f64,
    /// Inverse variance, up to a factor.
    pub(super) weight: f64,
}

/// `ln f′(t/τ)` of all times and of τ on a grid, for one softness.
#[derive(Clone, Debug)]
pub(super) struct FillTimes {
    times_us: Vec<f64>,
    well: SoftWell,
    ln_taus: Vec<f64>,
    /// `ln_slopes[τ][time]`.
    ln_slopes: Vec<Vec<f64>>,
}

/// The best fill time of a pixel.
#[derive(Clone, Copy, Debug)]
pub(super) struct Best {
    pub(super) full_well_time_us: f64,
    pub(super) cost: f64,
    /// Whether it lies at the end of the grid, where the pixel is practically linear.
    at_end: bool,
}

/// Steps of ln τ; a parabola through three costs interpolates between them.
const STEP: f64 = 0.02;
/// Steps of the first, coarse search; the cost has one valley.
const COARSE: usize = 12;
/// The largest τ, in units of the longest time: a fill of a quarter compresses by less than 1e-3 from p = 4 on.
const LARGEST: f64 = 4.0;

impl FillTimes {
    /// For `times_us` in increasing order.
    pub(super) fn new(times_us: &[f64], softness: f64) -> Self {
        let (well, longest) = (SoftWell { softness }, times_us.last().copied().unwrap_or(1.0));
        // A pixel that is full at its second time does not determine its fill time.
        let (low, high) = (times_us.get(1).copied().unwrap_or(longest).ln(), (LARGEST * longest).ln());
        let count = ((high - low) / STEP).ceil().max(2.0) as usize;
        let ln_taus: Vec<f64> = (0..=count).map(|i| low + STEP * i as f64).collect();
        let ln_slope = |ln_tau: f64| times_us.iter().map(|t| well.slope(t / ln_tau.exp()).ln()).collect();
        let ln_slopes = ln_taus.iter().map(|ln_tau| ln_slope(*ln_tau)).collect();
        Self { times_us: times_us.to_vec(), well, ln_taus, ln_slopes }
    }

    /// ln f′ of one time.
    pub(super) fn ln_slope(&self, time: usize, full_well_time_us: f64) -> f64 {
        self.well.slope(self.times_us[time] / full_well_time_us).ln()
    }

    /// e: weighted mean of ln (A_lin/t).
    pub(super) fn level(&self, samples: &[Sample], full_well_time_us: f64) -> f64 {
        let (mut sum, mut weights) = (0.0, 0.0);
        for s in samples {
            sum += s.weight * (s.ln_rate - self.ln_slope(s.time, full_well_time_us));
            weights += s.weight;
        }
        sum / weights
    }

    /// What a fill time leaves of each sample.
    pub(super) fn residuals(&self, samples: &[Sample], full_well_time_us: f64) -> Vec<f64> {
        let level = self.level(samples, full_well_time_us);
        samples.iter().map(|s| s.ln_rate - self.ln_slope(s.time, full_well_time_us) - level).collect()
    }

    /// Weighted sum of squares around the best level, with ln f′ by `ln_slope`.
    fn squares(samples: &[Sample], ln_slope: impl Fn(usize) -> f64) -> f64 {
        let (mut sum, mut square, mut weights) = (0.0, 0.0, 0.0);
        for s in samples {
            let misfit = s.ln_rate - ln_slope(s.time);
            sum += s.weight * misfit;
            square += s.weight * misfit * misfit;
            weights += s.weight;
        }
        if weights > 0.0 { (square - sum * sum / weights).max(0.0) } else { f64::INFINITY }
    }

    /// The fill time of least squares; `None` for fewer than three samples.
    pub(super) fn best(&self, samples: &[Sample]) -> Option<Best> {
        if samples.len() < 3 {
            return None;
        }
        let cost = |index: usize| Self::squares(samples, |time| self.ln_slopes[index][time]);
        let last = self.ln_taus.len() - 1;
        let least = |range: &mut dyn Iterator<Item = usize>| {
            range.map(|index| (index, cost(index))).min_by(|a, b| a.1.total_cmp(&b.1))
        };
        let (coarse, _) = least(&mut (0..=last).step_by(COARSE).chain([last]))?;
        let around = coarse.saturating_sub(COARSE)..=(coarse + COARSE).min(last);
        let (index, at_least) = least(&mut around.clone())?;
        let mut ln_tau = self.ln_taus[index];
        if index > 0 && index < last {
            let (before, after) = (cost(index - 1), cost(index + 1));
            let curvature = before - 2.0 * at_least + after;
            if curvature > 0.0 {
                ln_tau += 0.5 * STEP * (before - after) / curvature;
            }
        }
        Some(Best { full_well_time_us: ln_tau.exp(), cost: at_least, at_end: index == last })
    }

    /// The fill time with outliers left out; `None` where the pixel shows no compression: where a linear pixel explains
    /// it as well within three standard deviations (`sigma`, of a sample of weight 1).
    pub(super) fn robust(&self, samples: &[Sample], sigma: f64) -> Option<f64> {
        const SIGNIFICANT: f64 = 9.0;
        let first = self.best(samples)?;
        let residuals = self.residuals(samples, first.full_well_time_us);
        let reweighted: Vec<Sample> = samples
            .iter()
            .zip(residuals)
            .map(|(s, residual)| {
                let share = s.weight * tukey_share(residual, sigma);
                Sample { weight: s.weight * biweight(share), ..*s }
            })
            .collect();
        let best = self.best(&reweighted)?;
        let linear = Self::squares(&reweighted, |_| 0.0);
        let seen = !best.at_end && linear - best.cost > SIGNIFICANT * sigma * sigma;
        seen.then_some(best.full_well_time_us)
    }
}
