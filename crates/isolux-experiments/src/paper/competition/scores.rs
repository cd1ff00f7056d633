//! The figures that are compared, each with its unit and direction.

use super::field::Standing;
use super::methods::Competitor;

/// One figure of a competitor.
#[derive(Clone, Copy)]
pub(super) struct Score {
    /// Heading with unit.
    pub(super) heading: &'static str,
    /// In sentences.
    pub(super) name: &'static str,
    /// Its value; NaN where it is not determined.
    pub(super) of: fn(&Standing) -> f64,
    /// Distance from the ideal: smaller is better.
    pub(super) badness: fn(f64) -> f64,
    /// Decimals on the page.
    pub(super) decimals: usize,
    /// Unit behind a number in sentences.
    pub(super) unit: &'static str,
    /// Who competes: a step that leaves the effect in does not.
    pub(super) competes: fn(Competitor) -> bool,
}

const fn score(heading: &'static str, name: &'static str, of: fn(&Standing) -> f64) -> Score {
    Score {
        heading,
        name,
        of,
        badness: |value| value,
        decimals: 1,
        unit: "",
        competes: Competitor::uses_time,
    }
}

/// Median over pixels of the coefficient of variation over integration times, percent.
pub(super) const MEDIAN_CV: Score = Score {
    unit: " %",
    ..score("pixel CV, median, %", "the typical pixel's CV", |standing| {
        standing.comparison.after.pixel_cv.map_or(f64::NAN, |cv| 100.0 * cv.median)
    })
};
/// 95 % quantile of the same, percent.
pub(super) const P95_CV: Score = Score {
    unit: " %",
    ..score("pixel CV, 95 % quantile, %", "the worst twentieth's CV", |standing| {
        standing.comparison.after.pixel_cv.map_or(f64::NAN, |cv| 100.0 * cv.p95)
    })
};
/// Coefficient of variation of the image's mean, percent: what the paper plots.
pub(super) const IMAGE_CV: Score = Score {
    unit: " %",
    ..score("image mean CV, %", "the image mean's CV", |standing| {
        standing.comparison.after.image_cv.map_or(f64::NAN, |cv| 100.0 * cv.cv)
    })
};
/// Mean overlap of the masks of one threshold.
pub(super) const MEAN_IOU: Score = Score {
    badness: |value| -value,
    decimals: 3,
    ..score("threshold IoU, mean", "the threshold's mean IoU", |standing| {
        standing.comparison.after.threshold_iou.map_or(f64::NAN, |iou| iou.mean)
    })
};
/// Smallest overlap of the masks of one threshold.
pub(super) const WORST_IOU: Score = Score {
    badness: |value| -value,
    decimals: 3,
    ..score("threshold IoU, worst", "the threshold's worst IoU", |standing| {
        standing.comparison.after.threshold_iou.map_or(f64::NAN, |iou| iou.minimum)
    })
};
/// Relative noise after over before.
pub(super) const NOISE: Score = Score {
    decimals: 2,
    competes: Competitor::uses_distance,
    ..score("noise amplification", "the noise amplification", |standing| {
        standing.comparison.noise_amplification.unwrap_or(f64::NAN)
    })
};
/// Slope of ln A on ln d.
pub(super) const SLOPE: Score = Score {
    badness: f64::abs,
    decimals: 3,
    competes: Competitor::uses_distance,
    ..score("slope of ln A on ln d", "the slope of ln A on ln d", |standing| {
        standing.comparison.after.distance_slope.map_or(f64::NAN, |slope| slope.slope)
    })
};

/// The columns of the tables of the still scenes.
pub(super) const STILL: [Score; 6] = [MEDIAN_CV, P95_CV, IMAGE_CV, MEAN_IOU, WORST_IOU, NOISE];
