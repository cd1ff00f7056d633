//! Do the amplitudes of a few frames grow with the integration time, and fall with the distance, as a sensor's do?

use super::suspicion::Suspicion;
use crate::frame::{Frame, IntegrationTime, PixelFlags};
use crate::numerics::statistics::{SIGMA_PER_MAD, median, median_absolute_deviation, quantile};

/// Times that differ by less than this factor show noise.
const LEAST_TIME_RATIO: f64 = 1.5;
/// The distance of a pixel that stood still differs by less than this share.
const SAME_DISTANCE: f64 = 0.03;
/// Pixels above this share of the large amplitudes (99 %) may be compressed.
const LINEAR_SHARE: f64 = 0.5;
/// Pixels that a comparison needs.
const LEAST_PIXELS: usize = 200;
/// Exponents of single pixels that scatter by more than this (standard deviation) come from another scene.
const LARGEST_SCATTER: f64 = 0.25;
/// An exponent of t below this is none: corrected.
const CORRECTED_BELOW: f64 = 0.12;
/// From this one on, it is that of a sensor; compression takes some.
const RAW_FROM: f64 = 0.85;
/// An exponent of d nearer to 0 than this, of one labelled material, is none; a sensor's is -2.
const FLAT: f64 = 0.3;
/// Distances of a material must reach from one to this many times as far.
const LEAST_DISTANCE_RATIO: f64 = 1.5;

/// A sampled pixel.
#[derive(Clone, Copy, Debug)]
struct Pixel {
    amplitude: f32,
    distance_m: f32,
    label: u8,
}

/// Sampled pixels of the frames that were looked at, each with its time, µs.
#[derive(Clone, Debug, Default)]
pub(super) struct Exponents(Vec<(Option<f64>, Vec<Pixel>)>);

impl Exponents {
    pub(super) fn push(&mut self, frame: &Frame, stride: usize) {
        let time_us = match &frame.integration_time_us {
            IntegrationTime::PerFrame(time_us) => Some(*time_us),
            _ => None,
        };
        let unusable = PixelFlags::INVALID | PixelFlags::SATURATED;
        let pixel = |at: usize| {
            let usable = !frame.flags.values()[at].intersects(unusable);
            Pixel {
                amplitude: if usable { frame.amplitude.values()[at] } else { f32::NAN },
                distance_m: frame.distance_m.as_ref().map_or(f32::NAN, |plane| plane.values()[at]),
                label: frame.target.as_ref().map_or(0, |target| target.values()[at]),
            }
        };
        self.0.push((time_us, (0..frame.shape().pixels()).step_by(stride).map(pixel).collect()));
    }

    pub(super) fn suspicions(&self) -> Vec<Suspicion> {
        let of_time = self.of_time().and_then(|exponent| match exponent {
            _ if exponent.abs() < CORRECTED_BELOW => Some(Suspicion::TimeCorrected { exponent }),
            _ if (CORRECTED_BELOW..RAW_FROM).contains(&exponent) => Some(Suspicion::TimePartly { exponent }),
            _ => None,
        });
        let of_distance = self.of_distance().filter(|exponent| exponent.abs() < FLAT);
        let of_distance = of_distance.map(|exponent| Suspicion::DistanceCorrected { exponent });
        of_time.into_iter().chain(of_distance).collect()
    }

    /// Exponent of t from pixels that stood still between two frames: the largest of all pairs of frames. Saturation at
    /// long times and noise at short ones reduce it, nothing raises it.
    fn of_time(&self) -> Option<f64> {
        let mut found: Vec<f64> = Vec::new();
        for (at, (time, pixels)) in self.0.iter().enumerate() {
            for (other_time, others) in &self.0[..at] {
                let (Some(time), Some(other)) = (time, other_time) else { continue };
                let ln_ratio = (time / other).ln();
                if ln_ratio.abs() >= LEAST_TIME_RATIO.ln() {
                    found.extend(exponent(pixels, others, ln_ratio));
                }
            }
        }
        found.into_iter().reduce(f64::max)
    }

    /// Exponent of d of the label that shows it in most pixels.
    fn of_distance(&self) -> Option<f64> {
        let labelled =
            || self.0.iter().flat_map(|(time, pixels)| pixels.iter().map(move |pixel| (time, pixel)));
        let mut counts = [0usize; 256];
        labelled().for_each(|(_, pixel)| counts[usize::from(pixel.label)] += 1);
        counts[0] = 0;
        let label = (0..counts.len()).max_by_key(|&label| counts[label])?;
        let mut points: Vec<[f64; 2]> = labelled()
            .filter(|(_, pixel)| usize::from(pixel.label) == label && label > 0)
            .map(|(time, pixel)| {
                let rate = f64::from(pixel.amplitude) / time.unwrap_or(1.0);
                [f64::from(pixel.distance_m).ln(), rate.ln()]
            })
            .filter(|point| point.iter().all(|value| value.is_finite()))
            .collect();
        slope(&mut points)
    }
}

/// The exponent of t between two frames, if they show one still scene.
fn exponent(one: &[Pixel], other: &[Pixel], ln_ratio: f64) -> Option<f64> {
    let mut amplitudes: Vec<f64> =
        one.iter().chain(other).map(|p| f64::from(p.amplitude)).filter(|a| a.is_finite()).collect();
    let most = LINEAR_SHARE * quantile(&mut amplitudes, 0.99)?;
    let still = |(a, b): &(&Pixel, &Pixel)| {
        let moved = (f64::from(a.distance_m) / f64::from(b.distance_m) - 1.0).abs() > SAME_DISTANCE;
        let fine = |p: &Pixel| p.amplitude > 0.0 && f64::from(p.amplitude) < most;
        fine(a) && fine(b) && !moved
    };
    let exponents = one.iter().zip(other).filter(still);
    let mut exponents: Vec<f64> =
        exponents.map(|(a, b)| (f64::from(a.amplitude) / f64::from(b.amplitude)).ln() / ln_ratio).collect();
    if exponents.len() < LEAST_PIXELS.min(one.len() / 4) {
        return None;
    }
    let exponent = median(&mut exponents)?;
    // The values are deviations afterwards.
    let scatter = SIGMA_PER_MAD * median_absolute_deviation(&mut exponents)?;
    (scatter < LARGEST_SCATTER).then_some(exponent)
}

/// Slope between the medians of the nearest and the farthest third.
fn slope(points: &mut [[f64; 2]]) -> Option<f64> {
    if points.len() < LEAST_PIXELS {
        return None;
    }
    points.sort_unstable_by(|a, b| a[0].total_cmp(&b[0]));
    let third = points.len() / 3;
    let middle =
        |points: &[[f64; 2]], axis: usize| median(&mut points.iter().map(|p| p[axis]).collect::<Vec<_>>());
    let (near, far) = (&points[..third], &points[points.len() - third..]);
    let run = middle(far, 0)? - middle(near, 0)?;
    (run > LEAST_DISTANCE_RATIO.ln()).then_some((middle(far, 1)? - middle(near, 1)?) / run)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::{Plane, Shape};

    /// Frames of a still scene with labels, whose amplitudes go with t^`time` and d^`distance`.
    fn found(time: f64, distance: f64) -> Vec<Suspicion> {
        let shape = Shape::new(32, 32);
        let mut exponents = Exponents::default();
        for time_us in [400.0f64, 800.0, 1600.0] {
            let mut frame = Frame::new(shape);
            let d = |column: usize| 0.5 + 0.08 * column as f64;
            let amplitude = |row: usize, column: usize| {
                (1.0 + row as f64) * time_us.powf(time) * d(column).powf(distance)
            };
            frame.amplitude = Plane::from_fn(shape, |row, column| amplitude(row, column) as f32);
            frame.distance_m = Some(Plane::from_fn(shape, |_, column| d(column) as f32));
            frame.target = Some(Plane::filled(shape, 1));
            frame.integration_time_us = IntegrationTime::PerFrame(time_us);
            frame.flag_amplitude(None);
            exponents.push(&frame, 1);
        }
        exponents.suspicions()
    }

    #[test]
    fn what_was_taken_out_is_told_with_its_exponent() {
        assert_eq!(found(1.0, -2.0), []);
        let words: Vec<String> = found(0.5, -1.0).iter().map(ToString::to_string).collect();
        assert!(matches!(words.as_slice(), [words] if words.contains("t^0.50")), "{words:?}");
        let both = found(0.0, 0.0);
        let kinds = [
            matches!(both.first(), Some(Suspicion::TimeCorrected { .. })),
            matches!(both.last(), Some(Suspicion::DistanceCorrected { .. })),
        ];
        assert_eq!((both.len(), kinds), (2, [true; 2]), "{both:?}");
    }
}
