//! Names and directions of the figures, and their means and worst values over many conditions.

use super::stability::{Figures, Point, Stability};
use super::sweep::Variant;

/// A setting serves where its figure is at least this share of the one from frame to frame at the reference.
pub(super) const SERVED_SHARE: f64 = 0.8;
/// Frames below this are mostly noise, µs.
pub(super) const NOISE_BELOW_US: f64 = 1000.0;

/// One figure of merit.
#[derive(Clone, Copy, Debug)]
pub(super) struct Metric {
    /// As tables name it.
    pub(super) name: &'static str,
    /// Its value in [`Figures`].
    pub(super) of: fn(&Figures) -> f64,
    /// True when smaller is better.
    pub(super) smaller_is_better: bool,
}

/// Overlap of the masks of a fixed threshold.
pub(super) const THRESHOLD: Metric = share("threshold IoU", |figures| figures.threshold_iou);
/// F1 of Canny's edges.
pub(super) const EDGES: Metric = share("Canny F1", |figures| figures.edge_f1);
/// Overlap of the masks of Otsu's rule.
pub(super) const OTSU: Metric = share("Otsu IoU", |figures| figures.otsu_iou);
/// How far Otsu's level moves.
pub(super) const OTSU_DRIFT: Metric =
    Metric { name: "Otsu drift, |ln|", of: |figures| figures.otsu_ratio.ln().abs(), smaller_is_better: true };
/// Repeatability of FAST corners.
pub(super) const CORNERS: Metric = share("FAST repeated", |figures| figures.repeatability);
/// Matched BRIEF descriptors.
pub(super) const MATCHES: Metric = share("BRIEF matched", |figures| figures.matched);
/// All of them, in the order of the tables.
pub(super) const ALL: [Metric; 6] = [THRESHOLD, EDGES, OTSU, OTSU_DRIFT, CORNERS, MATCHES];

const fn share(name: &'static str, of: fn(&Figures) -> f64) -> Metric {
    Metric { name, of, smaller_is_better: false }
}

impl Metric {
    /// Value of a variant under the conditions of a point.
    pub(super) fn at(&self, point: &Point, variant: Variant) -> f64 {
        (self.of)(&point.figures[variant as usize])
    }

    /// Mean and worst value of a variant over the points.
    pub(super) fn mean_and_worst(&self, points: &[Point], variant: Variant) -> (f64, f64) {
        let values = || points.iter().map(|point| self.at(point, variant));
        let mean = values().sum::<f64>() / points.len() as f64;
        let worst =
            if self.smaller_is_better { values().fold(0.0, f64::max) } else { values().fold(1.0, f64::min) };
        (mean, worst)
    }

    /// The points at which the setting serves, of those in `points`; the yardstick is the value at the reference
    /// of the whole sweep.
    pub(super) fn served(&self, sweep: &Stability, points: &[Point], variant: Variant) -> Vec<Point> {
        let at_reference = self.at(&sweep.points[sweep.reference], variant);
        let serves = |point: &&Point| self.at(point, variant) >= SERVED_SHARE * at_reference;
        points.iter().filter(serves).copied().collect()
    }
}

/// The points that are not mostly noise.
pub(super) fn above_noise(points: &[Point]) -> Vec<Point> {
    points.iter().filter(|point| point.conditions.integration_time_us >= NOISE_BELOW_US).copied().collect()
}

/// The points of one integration time.
pub(super) fn at_time(points: &[Point], integration_time_us: f64) -> Vec<Point> {
    let same = |point: &&Point| point.conditions.integration_time_us == integration_time_us;
    points.iter().filter(same).copied().collect()
}
