//! Sampled pixels of one frame.

use crate::frame::{Frame, IntegrationTime, PixelFlags, Plane, Shape};
use crate::numerics::statistics::median;

/// Blocks along each side of the image: they must agree with each other.
const BLOCKS: usize = 8;
/// A largest value that more of the sampled pixels share is a clip, not a measurement.
const SHARED_LARGEST: usize = 8;

/// Which pixels of a frame are looked at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Grid {
    shape: Shape,
    stride: usize,
}

impl Grid {
    /// Sampled pixels of a frame, at most: their median is known to a thousandth.
    pub(crate) const SAMPLES: usize = 1 << 14;
    pub(crate) const BLOCKS: usize = BLOCKS * BLOCKS;

    pub(crate) fn new(shape: Shape) -> Self {
        // An odd number, so that columns do not alias with the width of the image.
        let stride =
            if shape.pixels() > Self::SAMPLES { shape.pixels().div_ceil(Self::SAMPLES) | 1 } else { 1 };
        Self { shape, stride }
    }

    pub(crate) fn shape(self) -> Shape {
        self.shape
    }

    fn pixels(self) -> impl Iterator<Item = usize> {
        (0..self.shape.pixels()).step_by(self.stride)
    }

    /// The block of the image that a sample lies in.
    pub(crate) fn block(self, sample: usize) -> usize {
        let (row, column) = self.shape.place(sample * self.stride);
        row * BLOCKS / self.shape.height * BLOCKS + column * BLOCKS / self.shape.width
    }
}

/// The integration time of a sampled frame.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum LookTime {
    Unknown,
    /// µs.
    Frame(f64),
    /// µs, for each sample.
    Samples(Vec<f32>),
}

/// Sampled pixels of one frame.
#[derive(Clone, Debug)]
pub(crate) struct Look {
    /// ln of the value, DN; NaN where there is none.
    pub(crate) ln_values: Vec<f32>,
    /// m; empty without distances.
    pub(crate) distance_m: Vec<f32>,
    pub(crate) time: LookTime,
    /// Median of `ln_values`: samples above it are bright.
    pub(crate) ln_middle: f32,
}

impl Look {
    /// Samples the amplitudes of a frame.
    pub(crate) fn of_frame(grid: Grid, frame: &Frame) -> Self {
        let (values, flags) = (frame.amplitude.values(), frame.flags.values());
        let value = |pixel: usize| {
            let usable = !flags[pixel].intersects(PixelFlags::INVALID | PixelFlags::SATURATED);
            if usable { values[pixel] } else { f32::NAN }
        };
        Self::new(grid, value, frame.distance_m.as_ref(), &frame.integration_time_us)
    }

    /// Samples `value` (DN; NaN where there is none) of each pixel.
    pub(crate) fn new(
        grid: Grid,
        value: impl Fn(usize) -> f32,
        distance_m: Option<&Plane<f32>>,
        time: &IntegrationTime,
    ) -> Self {
        let mut values: Vec<f32> = grid.pixels().map(value).collect();
        leave_out_clipped(&mut values);
        let ln = |value: f32| if value > 0.0 && value.is_finite() { value.ln() } else { f32::NAN };
        let ln_values: Vec<f32> = values.into_iter().map(ln).collect();
        let mut sorted: Vec<f64> = ln_values.iter().copied().filter(|v| !v.is_nan()).map(f64::from).collect();
        let at = |plane: &Plane<f32>| grid.pixels().map(|pixel| plane.values()[pixel]).collect();
        Self {
            distance_m: distance_m.map(at).unwrap_or_default(),
            time: match time {
                IntegrationTime::PerFrame(time_us) if *time_us > 0.0 => LookTime::Frame(*time_us),
                IntegrationTime::PerPixel(map) => LookTime::Samples(at(map)),
                _ => LookTime::Unknown,
            },
            ln_middle: median(&mut sorted).map_or(f32::NAN, |middle| middle as f32),
            ln_values,
        }
    }

    /// True where a sample has the same integration time in both, or none in either.
    pub(crate) fn same_time(&self, other: &Self, sample: usize) -> bool {
        let unknown = |time: f32| time.is_nan() || time <= 0.0;
        match (&self.time, &other.time) {
            (LookTime::Unknown, LookTime::Unknown) => true,
            (LookTime::Frame(one), LookTime::Frame(other)) => {
                IntegrationTime::same(*one, *other, IntegrationTime::SAME_RATIO)
            }
            (LookTime::Samples(one), LookTime::Samples(other)) => {
                let (one, other) = (one[sample], other[sample]);
                unknown(one) && unknown(other)
                    || IntegrationTime::same(one, other, IntegrationTime::SAME_RATIO)
            }
            _ => false,
        }
    }
}

/// Clipped values do not follow the exposure.
fn leave_out_clipped(values: &mut [f32]) {
    let Some(largest) = values.iter().copied().filter(|value| value.is_finite()).reduce(f32::max) else {
        return;
    };
    if values.iter().filter(|&&value| value == largest).count() > SHARED_LARGEST {
        values.iter_mut().filter(|value| **value == largest).for_each(|value| *value = f32::NAN);
    }
}
