//! Does the gain drift in the course of a sweep? Frames that should be equal tell how fast; whether that goes on from
//! one time or position to the next, or starts anew as when the camera settles, is told by parts of the image that
//! should be equal, or grow in proportion to the time.

use crate::frame::Frame;
use crate::numerics::statistics::{SIGMA_PER_MAD, median, median_absolute_deviation};

/// Compares consecutive frames that should be equal.
#[derive(Clone, Debug, Default)]
pub(super) struct DriftWatch {
    /// Amplitudes of the last frame, NaN where it is not valid.
    last: Vec<f32>,
    /// Number of the later frame, and by how much it is brighter, in ln.
    pairs: Vec<(usize, f64)>,
}

/// How the gain went.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Drift {
    /// Number of a frame, and ln of the gain there if its change between equal frames goes on between others.
    path: Vec<(usize, f64)>,
    /// Standard error of the whole path.
    error: f64,
}

/// Differences beyond this many standard deviations are no drift, but something that moved.
const CLIPPED_DEVIATIONS: f64 = 5.0;
/// Pairs that a drift is told from.
const LEAST_PAIRS: usize = 5;

impl DriftWatch {
    /// Takes a frame; `equal` states that it should be equal to the one before.
    pub(super) fn push(&mut self, number: usize, frame: &Frame, equal: bool) {
        let now = frame.counted_amplitudes();
        let mut sums = (0.0, 0.0);
        if equal && self.last.len() == frame.shape().pixels() {
            for (before, now) in self.last.iter_mut().zip(now) {
                if !before.is_nan() && !now.is_nan() {
                    sums = (sums.0 + f64::from(*before), sums.1 + f64::from(now));
                }
                *before = now;
            }
        } else {
            self.last.clear();
            self.last.extend(now);
        }
        let change = (sums.1 / sums.0).ln();
        if change.is_finite() {
            self.pairs.push((number, change));
        }
    }

    /// The drift over all frames; `None` with too few equal frames.
    pub(super) fn drift(&self) -> Option<Drift> {
        if self.pairs.len() < LEAST_PAIRS {
            return None;
        }
        let changes = || self.pairs.iter().map(|pair| pair.1);
        let usual = median(&mut changes().collect::<Vec<_>>())?;
        let sigma = SIGMA_PER_MAD * median_absolute_deviation(&mut changes().collect::<Vec<_>>())?;
        let clip = CLIPPED_DEVIATIONS * sigma.max(1e-9);
        let (mut path, mut ln_gain, mut last) = (Vec::new(), 0.0, self.pairs[0].0.saturating_sub(1));
        path.push((last, 0.0));
        for (number, change) in &self.pairs {
            ln_gain += (number - last) as f64 * change.clamp(usual - clip, usual + clip);
            last = *number;
            path.push((last, ln_gain));
        }
        let frames = (last - path[0].0) as f64;
        Some(Drift { path, error: sigma * frames / (self.pairs.len() as f64).sqrt() })
    }
}

impl Drift {
    /// Difference between the largest and the smallest gain, relative, with the sign of the change.
    pub(super) fn extent(&self) -> f64 {
        let [first, last] = self.ends();
        if first.0 <= last.0 { (last.1 - first.1).exp_m1() } else { (first.1 - last.1).exp_m1() }
    }

    /// True when the extent cannot be noise.
    pub(super) fn is_significant(&self) -> bool {
        let [first, last] = self.ends();
        last.1 - first.1 > CLIPPED_DEVIATIONS * self.error
    }

    /// Points of the smallest and of the largest gain.
    fn ends(&self) -> [(usize, f64); 2] {
        let by_gain = |a: &&(usize, f64), b: &&(usize, f64)| a.1.total_cmp(&b.1);
        let least = self.path.iter().min_by(by_gain).copied().unwrap_or((0, 0.0));
        let most = self.path.iter().max_by(by_gain).copied().unwrap_or((0, 0.0));
        [least, most]
    }

    fn at(&self, frame: f64) -> f64 {
        let above = self.path.partition_point(|point| (point.0 as f64) < frame);
        let above = above.clamp(1, self.path.len().max(2) - 1);
        let ((x0, y0), Some(&(x1, y1))) = (self.path[above - 1], self.path.get(above)) else { return 0.0 };
        y0 + (frame - x0 as f64) * (y1 - y0) / ((x1 - x0) as f64).max(1.0)
    }

    /// What witnesses (ln of gains at frames, each list up to a constant) say to the drift: the factor by which it must
    /// be multiplied to agree. About 1: it goes on from frame to frame. About 0: it starts anew at every change. `None`
    /// where the drift over their frames is too small to tell.
    pub(super) fn agreement(&self, witnesses: &[Vec<(f64, f64)>]) -> Option<f64> {
        /// Extent of the drift over the frames of a witness, in ln, below which nothing is told.
        const LEAST_EXTENT: f64 = 0.01;
        let (mut xx, mut xy, mut extent) = (0.0, 0.0, 0.0f64);
        for witness in witnesses {
            let points = || witness.iter().map(|&(frame, value)| (self.at(frame), value));
            let count = witness.len() as f64;
            let (x, y) = points().fold((0.0, 0.0), |(x, y), p| (x + p.0 / count, y + p.1 / count));
            xx += points().map(|p| (p.0 - x).powi(2)).sum::<f64>();
            xy += points().map(|p| (p.0 - x) * (p.1 - y)).sum::<f64>();
            let gains = || points().map(|p| p.0);
            extent =
                extent.max(gains().fold(f64::NEG_INFINITY, f64::max) - gains().fold(f64::INFINITY, f64::min));
        }
        (extent > LEAST_EXTENT && xx > 0.0).then_some(xy / xx)
    }
}

/// A drift is one when its witnesses agree with it to this factor either way.
const AGREEMENT: f64 = 0.4;

/// True when an [`agreement`](Drift::agreement) proves a drift.
pub(super) fn is_proven(agreement: f64) -> bool {
    (AGREEMENT..1.0 / AGREEMENT).contains(&agreement)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::Shape;

    fn watch(gain: impl Fn(usize) -> f32) -> Drift {
        let mut watch = DriftWatch::default();
        for number in 0..40 {
            let mut frame = Frame::new(Shape::new(4, 4));
            frame.amplitude.fill(gain(number));
            frame.flag_amplitude(None);
            watch.push(number, &frame, number % 2 == 1);
        }
        watch.drift().unwrap()
    }

    #[test]
    fn a_drift_goes_on_and_settling_does_not() {
        let drift = watch(|number| 100.0 * (1.0 + 0.005 * number as f32));
        assert!((drift.extent() - 0.195).abs() < 0.01 && drift.is_significant(), "{drift:?}");
        let true_gain: Vec<(f64, f64)> =
            (0..40).map(|i| (f64::from(i), (1.0 + 0.005 * f64::from(i)).ln())).collect();
        assert!((drift.agreement(&[true_gain]).unwrap() - 1.0).abs() < 0.1);
        let settling = watch(|number| if number % 2 == 0 { 99.0 } else { 100.0 });
        let level: Vec<(f64, f64)> = (0..40).map(|i| (f64::from(i), 0.0)).collect();
        assert!(settling.extent() > 0.3 && settling.agreement(&[level]).unwrap().abs() < 0.1);
    }
}
