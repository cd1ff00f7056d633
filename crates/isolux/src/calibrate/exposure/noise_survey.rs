//! Measures the noise of a recording: by how much amplitudes that should be equal differ, in groups of similar
//! light.

#[cfg(test)]
mod tests;

use std::collections::BTreeMap;

use crate::frame::{Frame, IntegrationTime, PixelFlags, Shape};
use crate::numerics::differences::trimmed_deviation;
use crate::numerics::statistics::{SIGMA_PER_MAD, median, median_absolute_deviation};
use crate::terms::noise::NoiseCell;
use crate::terms::{Noise, Source};

/// Group of pixels of similar time, amplitude and intensity: the upper bits of each f32, which order like the
/// values.
type Key = (u32, u32, u32);

/// Times within 1 % are one.
const TIME_SHIFT: u32 = 16;
/// Two groups per octave of amplitude or intensity.
const LIGHT_SHIFT: u32 = 22;
/// Number of frames whose spatial noise is measured; more would add nothing.
const SPATIAL_FRAMES: usize = 8;
/// Least number of differences in a group of a frame from which a deviation is computed.
const LEAST_DIFFERENCES: usize = 16;

/// Collects differences frame by frame: between consecutive frames of one integration time, or between neighbouring
/// pixels while there are no such frames. Memory does not grow with the number of frames.
///
/// Between frames, the mean difference of a group (a drift of the gain) is removed, and so are the largest 5 % of
/// the differences (movement). Between pixels, texture counts as noise.
#[derive(Clone, Debug)]
pub struct NoiseSurvey {
    shape: Shape,
    previous: Option<Kept>,
    temporal: BTreeMap<Key, Sums>,
    spatial: BTreeMap<Key, Sums>,
    spatial_frames: usize,
    groups: BTreeMap<Key, Group>,
    whole_numbers: bool,
}

impl Default for NoiseSurvey {
    fn default() -> Self {
        Self {
            shape: Shape::new(0, 0),
            previous: None,
            temporal: BTreeMap::new(),
            spatial: BTreeMap::new(),
            spatial_frames: 0,
            groups: BTreeMap::new(),
            whole_numbers: true,
        }
    }
}

/// A frame's measurements; NaN where a pixel takes no part.
#[derive(Clone, Debug, Default)]
struct Kept {
    amplitude: Vec<f32>,
    intensity: Option<Vec<f32>>,
    time_us: Vec<f32>,
}

/// Differences of one group in one frame, and sums of the values that were compared.
#[derive(Clone, Debug, Default)]
struct Group {
    differences: Vec<f64>,
    amplitude: f64,
    intensity: f64,
    time_us: f64,
}

/// One group over all frames; means weighted by the number of differences.
#[derive(Clone, Copy, Debug, Default)]
struct Sums {
    differences: f64,
    variance: f64,
    amplitude: f64,
    intensity: f64,
    time_us: f64,
}

/// The result of a survey.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct NoiseCells {
    /// The groups.
    pub cells: Vec<NoiseCell>,
    /// True when they come from neighbouring pixels, because there were no repeated frames.
    pub spatial: bool,
    /// Variance of the amplitude's own quantization, DN²: 1/12 where all amplitudes are whole numbers.
    pub quantization_variance_dn2: f64,
}

impl NoiseSurvey {
    /// A survey without frames.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// States that the next frame does not follow the last one, so that the two are not compared.
    pub fn interrupt(&mut self) {
        self.previous = None;
    }

    /// Takes the next frame. INVALID and SATURATED pixels do not count. A frame whose planes differ in shape is
    /// ignored.
    pub fn push(&mut self, frame: &Frame) {
        if frame.check_shapes().is_err() {
            return self.interrupt();
        }
        if frame.shape() != self.shape {
            self.interrupt();
            self.shape = frame.shape();
        }
        let now = Kept::of(frame);
        let whole = |value: &f32| value.is_nan() || value.fract() == 0.0;
        self.whole_numbers &= now.amplitude.iter().all(whole);
        if let Some(before) = self.previous.take().filter(|before| !before.is_another_scene(&now)) {
            self.difference_frames(&before, &now);
        }
        if self.temporal.is_empty() && self.spatial_frames < SPATIAL_FRAMES {
            self.difference_pixels(&now);
            self.spatial_frames += 1;
        }
        self.previous = Some(now);
    }

    fn difference_frames(&mut self, before: &Kept, now: &Kept) {
        for index in 0..now.amplitude.len() {
            if same(before.time_us[index], now.time_us[index]) {
                let difference = f64::from(now.amplitude[index]) - f64::from(before.amplitude[index]);
                self.add(difference, [(before, index), (now, index)]);
            }
        }
        settle(&mut self.groups, &mut self.temporal, 2.0, temporal_deviation);
    }

    fn difference_pixels(&mut self, now: &Kept) {
        let width = self.shape.width.max(1);
        for index in 1..now.amplitude.len().saturating_sub(1) {
            let inside = index % width != 0 && (index + 1) % width != 0;
            let one_time = same(now.time_us[index - 1], now.time_us[index])
                && same(now.time_us[index], now.time_us[index + 1]);
            if inside && one_time {
                let at = |index: usize| f64::from(now.amplitude[index]);
                let difference = at(index - 1) - 2.0 * at(index) + at(index + 1);
                self.add(difference, [(now, index - 1), (now, index + 1)]);
            }
        }
        settle(&mut self.groups, &mut self.spatial, 6.0, spatial_deviation);
    }

    /// Adds one difference of pixels with the mean light of two.
    fn add(&mut self, difference: f64, [(first, i), (second, j)]: [(&Kept, usize); 2]) {
        if !difference.is_finite() {
            return;
        }
        let amplitude = 0.5 * (first.amplitude[i] + second.amplitude[j]);
        let intensity = match (&first.intensity, &second.intensity) {
            (Some(first), Some(second)) => 0.5 * (first[i] + second[j]),
            _ => 0.0,
        };
        let time_us = second.time_us[j];
        let light = |value: f32| if value > 0.0 { value.to_bits() >> LIGHT_SHIFT } else { 0 };
        let key = (time_us.max(0.0).to_bits() >> TIME_SHIFT, light(amplitude), light(intensity));
        let group = self.groups.entry(key).or_default();
        group.differences.push(difference);
        group.amplitude += f64::from(amplitude);
        group.intensity += f64::from(intensity);
        group.time_us += f64::from(time_us);
    }

    /// The noise of the frames so far.
    #[must_use]
    pub fn finish(&self) -> NoiseCells {
        let spatial = self.temporal.is_empty();
        let found = if spatial { &self.spatial } else { &self.temporal };
        let cells = found.values().map(|sums| sums.cell()).collect();
        let quantization_variance_dn2 = if self.whole_numbers { 1.0 / 12.0 } else { 0.0 };
        NoiseCells { cells, spatial, quantization_variance_dn2 }
    }
}

impl Kept {
    fn of(frame: &Frame) -> Self {
        let excluded = PixelFlags::INVALID | PixelFlags::SATURATED;
        let counted = |(&value, flags): (&f32, &PixelFlags)| {
            if flags.intersects(excluded) { f32::NAN } else { value }
        };
        let amplitude: Vec<f32> =
            frame.amplitude.values().iter().zip(frame.flags.values()).map(counted).collect();
        let time_us = match &frame.integration_time_us {
            IntegrationTime::Unknown => vec![0.0; amplitude.len()],
            IntegrationTime::PerFrame(time_us) => vec![*time_us as f32; amplitude.len()],
            IntegrationTime::PerPixel(map) => map.values().to_vec(),
        };
        let intensity = frame.intensity.as_ref().map(|plane| plane.values().to_vec());
        Self { amplitude, intensity, time_us }
    }
}

impl Kept {
    /// True where two frames of one time differ far beyond noise: black frames and flashes tell nothing about it.
    fn is_another_scene(&self, now: &Self) -> bool {
        const LARGEST_CHANGE: f64 = 0.2;
        let sum = |kept: &Self| -> f64 {
            kept.amplitude.iter().filter(|value| !value.is_nan()).map(|value| f64::from(*value)).sum()
        };
        let (before, after) = (sum(self), sum(now));
        self.time_us.first() == now.time_us.first()
            && (after - before).abs() > LARGEST_CHANGE * before.max(after)
    }
}

/// True for two equal times, or two that are both unknown.
fn same(first_us: f32, second_us: f32) -> bool {
    first_us == second_us
}

/// Takes the groups of one frame into the sums; `factor` is the variance of a difference over that of a value.
fn settle(
    groups: &mut BTreeMap<Key, Group>,
    sums: &mut BTreeMap<Key, Sums>,
    factor: f64,
    deviation: fn(&mut [f64]) -> Option<f64>,
) {
    for (key, group) in groups.iter_mut() {
        let count = group.differences.len() as f64;
        if group.differences.len() >= LEAST_DIFFERENCES
            && let Some(deviation) = deviation(&mut group.differences)
        {
            let sums = sums.entry(*key).or_default();
            sums.differences += count;
            sums.variance += count * deviation * deviation / factor;
            sums.amplitude += group.amplitude;
            sums.intensity += group.intensity;
            sums.time_us += group.time_us;
        }
    }
    groups.clear();
}

/// Standard deviation of differences between frames, without their mean.
fn temporal_deviation(differences: &mut [f64]) -> Option<f64> {
    let common = median(differences)?;
    differences.iter_mut().for_each(|difference| *difference -= common);
    let count = differences.len() as f64;
    // Of few differences less than 95 % are kept. The variance of a normal law cut off on both sides falls from 0.7588
    // to 0.7203 when 93.75 % remain instead of 95 %.
    let cut = 0.95 - (0.95 * count).floor() / count;
    Some(trimmed_deviation(differences)? / (1.0 - 4.06 * cut).sqrt())
}

/// Standard deviation of differences between pixels, many of which may be edges.
fn spatial_deviation(differences: &mut [f64]) -> Option<f64> {
    Some(SIGMA_PER_MAD * median_absolute_deviation(differences)?)
}

impl Sums {
    fn cell(&self) -> NoiseCell {
        let mean = |sum: f64| sum / self.differences;
        NoiseCell {
            integration_time_us: Some(mean(self.time_us)).filter(|time_us| *time_us > 0.0),
            amplitude_dn: mean(self.amplitude),
            intensity_dn: Some(mean(self.intensity)).filter(|intensity| *intensity > 0.0),
            variance_dn2: mean(self.variance),
            differences: self.differences,
        }
    }
}

impl NoiseCells {
    /// The cells of several recordings together.
    #[must_use]
    pub fn merged<'a>(all: impl IntoIterator<Item = &'a Self>) -> Self {
        let mut merged = Self::default();
        for cells in all {
            merged.cells.extend(&cells.cells);
            merged.spatial |= cells.spatial;
            merged.quantization_variance_dn2 =
                merged.quantization_variance_dn2.max(cells.quantization_variance_dn2);
        }
        merged
    }

    /// Leaves out the cells of times above `longest_us`.
    pub(super) fn up_to(&mut self, longest_us: f64) {
        self.cells.retain(|cell| cell.integration_time_us.is_none_or(|time_us| time_us <= longest_us));
    }

    /// Fits the noise term to these cells; `None` where they do not determine it.
    #[must_use]
    pub fn fit(&self, fitted_on: Vec<Source>) -> Option<Noise> {
        Noise::fit(&self.cells, self.quantization_variance_dn2, fitted_on)
    }
}
