//! Relative noise: how much two frames that should be equal differ.

use serde::Serialize;

use crate::frame::{IntegrationTime, Plane, Shape};
use crate::numerics::differences::trimmed_deviation;
use crate::numerics::statistics::{Moments, SIGMA_PER_MAD, median, median_absolute_deviation, quantile};

use super::fraction::fraction;
use super::input::Times;
use super::outcome::{Outcome, Unavailable};

/// Differences that a frame must give for its noise to be estimated: fewer say nothing robust.
const MINIMUM_DIFFERENCES: usize = 16;
/// Share of the differences on either side that the mean drift of a frame leaves out: edges that moved.
const OUTER_SHARE: f64 = 0.05;
/// Frame pairs from which a pixel's own noise is taken; its relative error is then 1/√(2·4) = 35 %, small
/// against the factor 2 between strata.
const MINIMUM_PAIRS: u32 = 4;

/// Relative differences between frames above this are looked at closer: noise, or another view?
const LARGE: f64 = 0.2;
/// Of one view, frames differ from each other by no more than this many times what neighbouring pixels do.
const SAME_VIEW_RATIO: f64 = 3.0;

/// How the noise was estimated.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum NoiseMethod {
    /// From consecutive frames of one integration time.
    Temporal,
    /// From second differences along the rows of single frames, as no integration time was repeated. Texture
    /// counts as noise.
    Spatial,
}

/// Relative noise of a typical pixel in a single frame.
///
/// Temporal: standard deviation over pixels of Δln A between consecutive frames of one run, from the smaller 95 %
/// of its deviations, over √2, averaged over frame pairs; a drift common to all pixels drops out. What moves in
/// more than 5 % of the pixels counts as noise, but frames of another view, which differ from each other by far more than
/// neighbouring pixels do, are not compared. Spatial: 1.4826 · MAD of `ln A[c−1] − 2 ln A[c] + ln A[c+1]`, whose
/// outliers are the edges of the scene, over √6, averaged over frames; where more than half of these are equal
/// (coarsely quantized images), the same standard deviation as over time.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Noise {
    /// σ of A / A of one frame, dimensionless.
    pub relative: f64,
    /// How it was estimated.
    pub method: NoiseMethod,
    /// Frame pairs (temporal) or frames (spatial) that entered.
    pub frames: u32,
    /// Differences that entered / pixels of the frames that entered, 0..=1.
    pub valid_fraction: f64,
}

/// A robust σ of each frame's differences, averaged.
#[derive(Clone, Copy, Debug, Default)]
struct Estimate {
    sigma: Moments,
    differences: u64,
}

impl Estimate {
    /// Takes in one frame's differences, whose σ by `deviation` is `gain` times the noise of one value. Overwrites
    /// them.
    fn push(&mut self, differences: &mut [f64], gain: f64, deviation: fn(&mut [f64]) -> Option<f64>) {
        if differences.len() >= MINIMUM_DIFFERENCES
            && let Some(sigma) = deviation(differences)
        {
            self.sigma.push(sigma / gain);
            self.differences += differences.len() as u64;
        }
    }

    fn noise(&self, method: NoiseMethod, pixels: usize) -> Option<Noise> {
        let frames = self.sigma.count();
        let valid_fraction = fraction(self.differences, u64::from(frames) * pixels as u64);
        self.sigma.mean().map(|relative| Noise { relative, method, frames, valid_fraction })
    }
}

/// σ of differences in time. No median deviation: it is 0 where more than half of the pixels of a coarsely
/// quantized image stay on their step.
fn temporal_sigma(differences: &mut [f64]) -> Option<f64> {
    centre(differences)?;
    trimmed_deviation(differences)
}

/// σ of differences in space. Edges of the scene are far more than 5 % of these, so the median deviation is used
/// wherever it is one. `differences` are overwritten with their absolute deviations, which serve the other too.
fn spatial_sigma(differences: &mut [f64]) -> Option<f64> {
    match median_absolute_deviation(differences)? {
        0.0 => trimmed_deviation(differences),
        deviation => Some(SIGMA_PER_MAD * deviation),
    }
}

/// Subtracts the common drift: the mean without the outer differences. The median alone would be off by up to half
/// a step of a quantized image; it comes first so that equal differences become exactly 0.
fn centre(differences: &mut [f64]) -> Option<()> {
    let middle = median(differences)?;
    differences.iter_mut().for_each(|difference| *difference -= middle);
    let (low, high) = (quantile(differences, OUTER_SHARE)?, quantile(differences, 1.0 - OUTER_SHARE)?);
    let mut inner = Moments::default();
    differences.iter().filter(|difference| (low..=high).contains(*difference)).for_each(|d| inner.push(*d));
    let mean = inner.mean()?;
    differences.iter_mut().for_each(|difference| *difference -= mean);
    Some(())
}

/// Times of the previous frame, kept.
#[derive(Clone, Debug)]
enum KeptTimes {
    Uniform(f32),
    PerPixel(Vec<f32>),
}

/// Collects differences from frame to frame and from pixel to pixel.
#[derive(Clone, Debug)]
pub(super) struct NoiseMeter {
    shape: Shape,
    same_time_ratio: f64,
    previous: Vec<f32>,
    previous_times: KeptTimes,
    squares: Vec<f64>,
    pairs: Vec<u32>,
    temporal: Estimate,
    spatial: Estimate,
    scratch: Vec<f64>,
}

impl NoiseMeter {
    pub(super) fn new(shape: Shape, same_time_ratio: f64) -> Self {
        let pixels = shape.pixels();
        Self {
            shape,
            same_time_ratio,
            previous: vec![f32::NAN; pixels],
            previous_times: KeptTimes::Uniform(0.0),
            squares: vec![0.0; pixels],
            pairs: vec![0; pixels],
            temporal: Estimate::default(),
            spatial: Estimate::default(),
            scratch: Vec::new(),
        }
    }

    /// Takes in a frame; NaN = unusable. Frames of unknown time count as one run.
    pub(super) fn push(&mut self, usable: &[f32], times: Times<'_>) {
        self.difference_frames(usable, times);
        if self.temporal.sigma.count() == 0 {
            self.difference_pixels(usable, times);
        }
        self.previous.copy_from_slice(usable);
        match (times, &mut self.previous_times) {
            (Times::PerPixel(map), KeptTimes::PerPixel(kept)) => kept.copy_from_slice(map),
            (Times::PerPixel(map), kept) => *kept = KeptTimes::PerPixel(map.to_vec()),
            (Times::Uniform(time), kept) => *kept = KeptTimes::Uniform(time),
        }
    }

    fn difference_frames(&mut self, usable: &[f32], times: Times<'_>) {
        let previous_times = match &self.previous_times {
            KeptTimes::Uniform(time) => Times::Uniform(*time),
            KeptTimes::PerPixel(map) => Times::PerPixel(map),
        };
        let comparable = |index: usize, now: f32, before: f32| {
            let both = !now.is_nan() && !before.is_nan();
            both && IntegrationTime::same(times.at(index), previous_times.at(index), self.same_time_ratio)
        };
        self.scratch.clear();
        for (index, (&now, &before)) in usable.iter().zip(&self.previous).enumerate() {
            if comparable(index, now, before) {
                self.scratch.push((f64::from(now) / f64::from(before)).ln());
            }
        }
        // The difference of two values has twice the variance of one.
        let mut estimate = Estimate::default();
        estimate.push(&mut self.scratch, 2f64.sqrt(), temporal_sigma);
        let Some(sigma) = estimate.sigma.mean() else { return };
        if sigma > LARGE
            && self.spatial_noise(usable, times).is_some_and(|noise| sigma > SAME_VIEW_RATIO * noise)
        {
            return;
        }
        self.temporal.sigma.push(sigma);
        self.temporal.differences += estimate.differences;
        for (index, (&now, &before)) in usable.iter().zip(&self.previous).enumerate() {
            if comparable(index, now, before) {
                let difference = f64::from(now) - f64::from(before);
                self.squares[index] += difference * difference;
                self.pairs[index] = self.pairs[index].saturating_add(1);
            }
        }
    }

    /// Relative noise of a frame by its neighbouring pixels.
    fn spatial_noise(&self, usable: &[f32], times: Times<'_>) -> Option<f64> {
        let (mut differences, mut estimate) = (Vec::new(), Estimate::default());
        self.second_differences(usable, times, &mut differences);
        estimate.push(&mut differences, 6f64.sqrt(), spatial_sigma);
        estimate.sigma.mean()
    }

    fn difference_pixels(&mut self, usable: &[f32], times: Times<'_>) {
        let mut differences = std::mem::take(&mut self.scratch);
        differences.clear();
        self.second_differences(usable, times, &mut differences);
        // Weights 1, −2, 1: six times the variance of one value.
        self.spatial.push(&mut differences, 6f64.sqrt(), spatial_sigma);
        self.scratch = differences;
    }

    fn second_differences(&self, usable: &[f32], times: Times<'_>, out: &mut Vec<f64>) {
        let width = self.shape.width;
        for (row, values) in usable.chunks_exact(width.max(1)).enumerate() {
            for (column, triple) in values.windows(3).enumerate() {
                let index = row * width + column;
                let one_time = (1..3).all(|step| {
                    IntegrationTime::same(times.at(index), times.at(index + step), self.same_time_ratio)
                });
                let [left, centre, right] = [0, 1, 2].map(|step| f64::from(triple[step]).ln());
                let second_difference = left - 2.0 * centre + right;
                if one_time && second_difference.is_finite() {
                    out.push(second_difference);
                }
            }
        }
    }

    pub(super) fn finish(&self) -> Outcome<Noise> {
        let pixels = self.shape.pixels();
        self.temporal
            .noise(NoiseMethod::Temporal, pixels)
            .or_else(|| self.spatial.noise(NoiseMethod::Spatial, pixels))
            .ok_or(Unavailable::NoNoiseEstimate)
    }

    /// σ of each pixel in one frame, in the unit of the values: `√(Σ Δ² / 2n)` over its n pairs of consecutive
    /// frames of one run; `None` for fewer than four pairs.
    pub(super) fn pixel_sigma(&self) -> impl Iterator<Item = Option<f64>> {
        self.squares.iter().zip(&self.pairs).map(|(&squares, &pairs)| {
            (pairs >= MINIMUM_PAIRS).then(|| (squares / (2.0 * f64::from(pairs))).sqrt())
        })
    }

    /// Signal-to-noise ratio of each pixel whose `means` and σ are known; infinite where σ is 0, NaN elsewhere.
    pub(super) fn signal_to_noise(&self, means: impl Iterator<Item = Option<f64>>) -> Outcome<Plane<f32>> {
        let ratio = |(mean, sigma): (Option<f64>, Option<f64>)| match (mean, sigma) {
            (Some(mean), Some(sigma)) => (mean / sigma) as f32,
            _ => f32::NAN,
        };
        let ratios: Vec<f32> = means.zip(self.pixel_sigma()).map(ratio).collect();
        if ratios.iter().all(|ratio| ratio.is_nan()) {
            return Err(Unavailable::NoRepeatedFrames);
        }
        Plane::from_vec(self.shape, ratios).map_err(|_| Unavailable::NoRepeatedFrames)
    }
}
