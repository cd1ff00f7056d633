//! Is there anything but noise?

use super::suspicion::Suspicion;
use crate::frame::{Frame, PixelFlags};
use crate::numerics::statistics::{SIGMA_PER_MAD, median, quantile};

/// Where nine tenths of the image have a ratio of amplitude to noise below this, it shows nothing. For pure noise (Rayleigh's
/// distribution, means of two pixels) that ratio is 2.8.
const LEAST_SIGNAL_TO_NOISE: f64 = 3.5;
/// A target in a dark room fills a part of the image only.
const QUANTILE: f64 = 0.9;
/// Pairs of pixels that a frame needs.
const LEAST_PAIRS: usize = 64;

/// Compares neighbouring pixels. Neighbours differ by a third of their value in noise alone, not in scenes; frames are not
/// compared, because those that follow each other may show other views.
#[derive(Clone, Debug, Default)]
pub(super) struct Dark {
    /// The amplitude of the brightest tenth over noise, of each frame.
    ratios: Vec<f64>,
}

impl Dark {
    pub(super) fn push(&mut self, frame: &Frame, stride: usize) {
        let (values, flags, width) =
            (frame.amplitude.values(), frame.flags.values(), frame.shape().width.max(1));
        let usable = |at: usize| !flags[at].intersects(PixelFlags::INVALID | PixelFlags::SATURATED);
        let pairs = (0..values.len()).step_by(stride).filter(|at| at % width + 1 < width);
        let pairs = pairs.filter(|&at| usable(at) && usable(at + 1));
        let pairs: Vec<[f64; 2]> =
            pairs.map(|at| [f64::from(values[at]), f64::from(values[at + 1])]).collect();
        self.ratios.extend(signal_to_noise(&pairs));
    }

    pub(super) fn suspicion(mut self) -> Option<Suspicion> {
        let signal_to_noise = median(&mut self.ratios)?;
        (signal_to_noise < LEAST_SIGNAL_TO_NOISE).then_some(Suspicion::TooDark { signal_to_noise })
    }
}

/// The amplitude from which on the brightest tenth begins, over the noise of a pixel.
fn signal_to_noise(pairs: &[[f64; 2]]) -> Option<f64> {
    if pairs.len() < LEAST_PAIRS {
        return None;
    }
    let mut means: Vec<f64> = pairs.iter().map(|[a, b]| f64::midpoint(*a, *b)).collect();
    let mut differences: Vec<f64> = pairs.iter().map(|[a, b]| (a - b).abs()).collect();
    let noise = SIGMA_PER_MAD * median(&mut differences)? / std::f64::consts::SQRT_2;
    // Equal neighbours are coarse: they show no noise.
    (noise > 0.0).then_some(quantile(&mut means, QUANTILE)? / noise)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::{Plane, Shape};

    /// A frame whose pixels alternate about `level` by `noise`.
    fn found(level: f32, noise: f32) -> Option<Suspicion> {
        let shape = Shape::new(16, 16);
        let mut frame = Frame::new(shape);
        let sign = |column: usize| if column.is_multiple_of(2) { 1.0 } else { -1.0 };
        frame.amplitude = Plane::from_fn(shape, |_, column| level + sign(column) * noise);
        frame.flag_amplitude(None);
        let mut dark = Dark::default();
        dark.push(&frame, 1);
        dark.suspicion()
    }

    #[test]
    fn neighbours_that_differ_as_much_as_they_show_are_noise() {
        // The difference is twice the noise here: 1.4826 · 2 / √2 of it.
        let Some(Suspicion::TooDark { signal_to_noise }) = found(10.0, 5.0) else { panic!() };
        assert!((signal_to_noise - 10.0 / (5.0 * 2.0966)).abs() < 1e-3, "{signal_to_noise}");
        assert_eq!(found(100.0, 5.0), None);
        assert_eq!(found(10.0, 0.0), None);
    }
}
