//! Measures by how much amplitudes that should be equal differ, in groups of similar pixels.

use std::collections::BTreeMap;

use crate::frame::Shape;
use crate::numerics::differences::trimmed_deviation;
use crate::numerics::statistics::{SIGMA_PER_MAD, median, median_absolute_deviation};

/// Group of pixels of similar class, amplitude and light: the upper bits of each f32, which order like the values.
type Key = (u32, u32, u32);

/// Classes within 1 % are one.
const CLASS_SHIFT: u32 = 16;
/// Two groups per octave of amplitude or light.
const LIGHT_SHIFT: u32 = 22;
/// Number of frames whose spatial noise is measured; more would add nothing.
const SPATIAL_FRAMES: usize = 8;
/// Least number of differences in a group of a frame from which a deviation is computed.
const LEAST_DIFFERENCES: usize = 16;

/// Collects differences frame by frame: between consecutive frames of one class, or between neighbouring pixels while
/// there are no such frames. Memory does not grow with the number of frames.
///
/// Between frames, the mean difference of a group (a drift of the gain) is removed, and so are the largest 5 % of
/// the differences (movement). Between pixels, texture counts as noise.
#[derive(Clone, Debug)]
pub(super) struct GroupedNoise {
    /// Every so manieth pixel is looked at.
    stride: usize,
    shape: Shape,
    previous: Option<Compared>,
    temporal: BTreeMap<Key, Sums>,
    spatial: BTreeMap<Key, Sums>,
    spatial_frames: usize,
    groups: BTreeMap<Key, Group>,
}

/// What is compared of a frame; NaN where a pixel takes no part.
#[derive(Clone, Debug, Default)]
pub(super) struct Compared {
    /// DN.
    pub(super) amplitude: Vec<f32>,
    /// What tells groups apart besides the amplitude: the intensity, for example.
    pub(super) light: Option<Vec<f32>>,
    /// What must be equal for two pixels to be compared: the integration time, for example.
    pub(super) class: Vec<f32>,
}

/// The noise of one group of pixels, and their means.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct GroupNoise {
    pub(super) class: f64,
    pub(super) amplitude_dn: f64,
    pub(super) light: f64,
    /// Variance of one amplitude, DN².
    pub(super) variance_dn2: f64,
    pub(super) differences: f64,
}

/// Differences of one group in one frame, and sums of the values that were compared.
#[derive(Clone, Debug, Default)]
struct Group {
    differences: Vec<f64>,
    amplitude: f64,
    light: f64,
    class: f64,
}

/// One group over all frames; means weighted by the number of differences.
#[derive(Clone, Copy, Debug, Default)]
struct Sums {
    differences: f64,
    variance: f64,
    amplitude: f64,
    light: f64,
    class: f64,
}

impl Compared {
    /// True where two frames of one class differ far beyond noise: black frames and flashes tell nothing about it.
    fn is_another_scene(&self, now: &Self) -> bool {
        const LARGEST_CHANGE: f64 = 0.2;
        let sum = |compared: &Self| -> f64 {
            compared.amplitude.iter().filter(|value| !value.is_nan()).map(|value| f64::from(*value)).sum()
        };
        let (before, after) = (sum(self), sum(now));
        self.class.first() == now.class.first() && (after - before).abs() > LARGEST_CHANGE * before.max(after)
    }
}

impl GroupedNoise {
    pub(super) fn new(stride: usize) -> Self {
        Self {
            stride,
            shape: Shape::new(0, 0),
            previous: None,
            temporal: BTreeMap::new(),
            spatial: BTreeMap::new(),
            spatial_frames: 0,
            groups: BTreeMap::new(),
        }
    }

    /// States that the next frame does not follow the last one, so that the two are not compared.
    pub(super) fn interrupt(&mut self) {
        self.previous = None;
    }

    /// Takes the next frame, all of whose planes have this shape.
    pub(super) fn push(&mut self, shape: Shape, now: Compared) {
        if shape != self.shape {
            self.interrupt();
            self.shape = shape;
        }
        if let Some(before) = self.previous.take().filter(|before| !before.is_another_scene(&now)) {
            self.difference_frames(&before, &now);
        }
        if self.temporal.is_empty() && self.spatial_frames < SPATIAL_FRAMES {
            self.difference_pixels(&now);
            self.spatial_frames += 1;
        }
        self.previous = Some(now);
    }

    fn difference_frames(&mut self, before: &Compared, now: &Compared) {
        for index in (0..now.amplitude.len()).step_by(self.stride) {
            if same(before.class[index], now.class[index]) {
                let difference = f64::from(now.amplitude[index]) - f64::from(before.amplitude[index]);
                self.add(difference, [(before, index), (now, index)]);
            }
        }
        settle(&mut self.groups, &mut self.temporal, 2.0, temporal_deviation);
    }

    fn difference_pixels(&mut self, now: &Compared) {
        let width = self.shape.width.max(1);
        for index in (1..now.amplitude.len().saturating_sub(1)).step_by(self.stride) {
            let inside = index % width != 0 && (index + 1) % width != 0;
            let one_class =
                same(now.class[index - 1], now.class[index]) && same(now.class[index], now.class[index + 1]);
            if inside && one_class {
                let at = |index: usize| f64::from(now.amplitude[index]);
                let difference = at(index - 1) - 2.0 * at(index) + at(index + 1);
                self.add(difference, [(now, index - 1), (now, index + 1)]);
            }
        }
        settle(&mut self.groups, &mut self.spatial, 6.0, spatial_deviation);
    }

    /// Adds one difference of pixels with the mean light of two.
    fn add(&mut self, difference: f64, [(first, i), (second, j)]: [(&Compared, usize); 2]) {
        if !difference.is_finite() {
            return;
        }
        let amplitude = 0.5 * (first.amplitude[i] + second.amplitude[j]);
        let light = match (&first.light, &second.light) {
            (Some(first), Some(second)) => 0.5 * (first[i] + second[j]),
            _ => 0.0,
        };
        let class = second.class[j];
        let octaves = |value: f32| if value > 0.0 { value.to_bits() >> LIGHT_SHIFT } else { 0 };
        let key = (class.max(0.0).to_bits() >> CLASS_SHIFT, octaves(amplitude), octaves(light));
        let group = self.groups.entry(key).or_default();
        group.differences.push(difference);
        group.amplitude += f64::from(amplitude);
        group.light += f64::from(light);
        group.class += f64::from(class);
    }

    /// The same, and forgets the frames.
    pub(super) fn take(&mut self) -> (Vec<GroupNoise>, bool) {
        let found = self.finish();
        *self = Self::new(self.stride);
        found
    }

    /// The noise of the frames so far, group by group, and whether it comes from neighbouring pixels.
    pub(super) fn finish(&self) -> (Vec<GroupNoise>, bool) {
        let spatial = self.temporal.is_empty();
        let found = if spatial { &self.spatial } else { &self.temporal };
        (found.values().map(|sums| sums.noise()).collect(), spatial)
    }
}

/// True for two equal classes.
fn same(first: f32, second: f32) -> bool {
    first == second
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
            sums.light += group.light;
            sums.class += group.class;
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
    fn noise(&self) -> GroupNoise {
        let mean = |sum: f64| sum / self.differences;
        GroupNoise {
            class: mean(self.class),
            amplitude_dn: mean(self.amplitude),
            light: mean(self.light),
            variance_dn2: mean(self.variance),
            differences: self.differences,
        }
    }
}
