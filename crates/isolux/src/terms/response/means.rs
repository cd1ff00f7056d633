//! Means of a still scene at several integration times: what all tiers but the scalar one are fitted to.

use crate::frame::Shape;

/// Mean amplitudes of every pixel of a still scene, one image per integration time.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct AmplitudeStack {
    shape: Shape,
    integration_time_us: Vec<f64>,
    amplitude_dn: Vec<f32>,
}

/// Means over the frames of one integration time of one pixel. NaN for what was not delivered or not valid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PixelMeans {
    /// Integration time, µs.
    pub integration_time_us: f64,
    /// Amplitude, DN.
    pub amplitude_dn: f64,
    /// DC image, DN.
    pub intensity_dn: f64,
    /// Raw bins A1..A4, DN.
    pub phase_samples_dn: [f64; 4],
    /// Whether any frame flagged the pixel as saturated or as no measurement.
    pub unusable: bool,
}

/// One pixel of a still scene, in the order of time.
pub(crate) type PixelSeries = Vec<PixelMeans>;

impl AmplitudeStack {
    /// A stack without images.
    #[must_use]
    pub(crate) fn new(shape: Shape) -> Self {
        Self { shape, integration_time_us: Vec::new(), amplitude_dn: Vec::new() }
    }

    /// Height and width.
    #[must_use]
    pub(crate) fn shape(&self) -> Shape {
        self.shape
    }

    /// Integration times, µs, as they were pushed.
    #[must_use]
    pub(crate) fn integration_time_us(&self) -> &[f64] {
        &self.integration_time_us
    }

    /// Adds the mean amplitudes (DN, row-major; NaN where a pixel is invalid or saturated) of one time, µs. Values
    /// beyond the shape do not enter, and missing ones are NaN.
    pub(crate) fn push(&mut self, integration_time_us: f64, amplitude_dn: impl IntoIterator<Item = f32>) {
        let pixels = self.shape.pixels();
        self.integration_time_us.push(integration_time_us);
        self.amplitude_dn.extend(amplitude_dn.into_iter().take(pixels));
        self.amplitude_dn.resize(self.integration_time_us.len() * pixels, f32::NAN);
    }

    /// Drops every second image.
    pub(crate) fn thin_out(&mut self) {
        self.retain(|index| index.is_multiple_of(2));
    }

    /// Makes NaN of the pixels of an image that are `excluded`.
    pub(crate) fn exclude(&mut self, image: usize, excluded: impl Fn(usize) -> bool) {
        let pixels = self.shape.pixels();
        let values = self.amplitude_dn[image * pixels..(image + 1) * pixels].iter_mut().enumerate();
        values.filter(|(pixel, _)| excluded(*pixel)).for_each(|(_, value)| *value = f32::NAN);
    }

    /// Keeps the images that are `wanted`.
    pub(crate) fn retain(&mut self, wanted: impl Fn(usize) -> bool) {
        let (pixels, mut kept) = (self.shape.pixels(), 0);
        for index in (0..self.integration_time_us.len()).filter(|index| wanted(*index)) {
            self.integration_time_us[kept] = self.integration_time_us[index];
            self.amplitude_dn.copy_within(index * pixels..(index + 1) * pixels, kept * pixels);
            kept += 1;
        }
        self.integration_time_us.truncate(kept);
        self.amplitude_dn.truncate(kept * pixels);
    }

    /// Amplitude of one pixel in one image, DN.
    pub(super) fn at(&self, image: usize, pixel: usize) -> f64 {
        f64::from(self.amplitude_dn[image * self.shape.pixels() + pixel])
    }

    /// Indices of the images in the order of time.
    pub(super) fn order(&self) -> Vec<usize> {
        let mut order: Vec<usize> = (0..self.integration_time_us.len()).collect();
        order.sort_by(|&a, &b| self.integration_time_us[a].total_cmp(&self.integration_time_us[b]));
        order
    }
}

/// Of a pixel's amplitudes in the order of time, how many lie on the rising branch that can be trusted (methods,
/// section 2): before the first that exceeds 0.97 of the pixel's peak where the curve has flattened.
///
/// A pixel that still rises in proportion is at no peak, whatever its last value; flat is a local exponent of the
/// amplitude over time below one half.
pub(super) fn rising(series: &[(f64, f64)]) -> usize {
    const NEAR_PEAK: f64 = 0.97;
    const FLAT: f64 = 0.5;
    let peak = series.iter().map(|(_, amplitude)| *amplitude).fold(0.0, f64::max);
    let flattened = |i: usize| {
        let ((t0, a0), (t1, a1)) = (series[i - 1], series[i]);
        a1 > NEAR_PEAK * peak && (a1 / a0).ln() < FLAT * (t1 / t0).ln()
    };
    (1..series.len()).find(|&i| flattened(i)).unwrap_or(series.len())
}

/// The level at which values stop growing with time: the hard clip, or the end of the well. `series` hold (time, value
/// above the black level) in the order of time; `None` when fewer than 8 values have stopped.
pub(super) fn plateau(series: impl IntoIterator<Item = Vec<(f64, f64)>>) -> Option<f64> {
    const LEAST_VALUES: usize = 8;
    const FLAT: f64 = 0.02;
    let mut levels = Vec::new();
    for series in series {
        for pair in series.windows(2) {
            let [(t0, y0), (t1, y1)] = pair else { continue };
            if *y0 > 0.0 && *t1 > 1.02 * t0 && (y1 / y0).ln() < FLAT * (t1 / t0).ln() {
                levels.push(*y1);
            }
        }
    }
    // Noise may stop values at any level, a clip only at the largest.
    let top = levels.iter().copied().fold(0.0, f64::max);
    levels.retain(|level| *level > 0.97 * top);
    (levels.len() >= LEAST_VALUES).then(|| crate::numerics::statistics::median(&mut levels)).flatten()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_a_flattened_curve_has_a_peak() {
        let linear: Vec<(f64, f64)> = (1..9).map(|i| (f64::from(i), 10.0 * f64::from(i))).collect();
        assert_eq!(rising(&linear), 8);
        let bent = [(1.0, 10.0), (2.0, 19.0), (4.0, 30.0), (5.0, 31.0), (6.0, 20.0)];
        assert_eq!(rising(&bent), 3);
    }

    #[test]
    fn a_clip_is_found_where_values_stop_and_noise_is_none() {
        let times: Vec<f64> = (1..20).map(f64::from).collect();
        let clipped = |rate: f64| times.iter().map(|t| (*t, (rate * t).min(90.0))).collect::<Vec<_>>();
        assert_eq!(plateau([clipped(10.0), clipped(20.0)]), Some(90.0));
        assert_eq!(plateau([clipped(1.0)]), None);
    }

    #[test]
    fn thinning_keeps_every_second_image() {
        let mut stack = AmplitudeStack::new(Shape::new(1, 2));
        for time in 1..=5u8 {
            stack.push(f64::from(time), [f32::from(time), 0.5]);
        }
        stack.thin_out();
        assert_eq!(stack.integration_time_us(), [1.0, 3.0, 5.0]);
        assert_eq!([0, 1, 2].map(|image| stack.at(image, 0)), [1.0, 3.0, 5.0]);
    }
}
