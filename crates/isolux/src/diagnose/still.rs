//! The same pixels at several integration times: their material and distance cancel.

use serde::Serialize;

use super::effect::{Effect, Estimate, Evidence, State};
use super::limits::{MINIMUM_FRAME_CLUSTERS, MINIMUM_ROWS};
use super::unavailable::Outcome;
use crate::numerics::regression::{Intercepts, Regression, Row};
use crate::numerics::robust::Loss;
use crate::numerics::statistics::quantile;

/// Values above this fraction of the large ones (99.5 %) may be compressed: the exponent comes from below.
const LINEAR_SHARE: f64 = 0.5;
/// ... unless less than this share of the values would be left.
const ENOUGH_SHARE: f64 = 0.25;
/// A pixel is over-saturated where it has risen to its peak by this factor and falls from it again.
const OVER_SATURATED: f64 = 0.8;
/// Slopes by level are taken between times at least this factor apart: closer ones would show noise.
const STEP_RATIO: f64 = 1.3;
/// Bands of amplitude in which the exponent is given.
const BANDS: usize = 4;

/// The exponent of t in one band of amplitude.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Band {
    /// Median amplitude of the band, DN.
    pub amplitude_dn: f64,
    /// d ln A / d ln t between neighbouring times.
    pub exponent: Estimate,
}

/// What the same pixels at several times tell.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StillPixels {
    /// Exponent of t at amplitudes below half of the large ones.
    pub effect: Effect,
    /// The exponent by amplitude, ascending; empty where there are too few values.
    pub bands: Vec<Band>,
    /// Pixels that entered; one that saw several scenes counts for each.
    pub pixels: usize,
    /// Pairs of scene and integration time that entered.
    pub levels: usize,
    /// Share of the values that were seen before another scene than the first, 0..=1; each scene counts for itself.
    pub moved_fraction: f64,
}

/// One pixel of one scene at one time.
#[derive(Clone, Copy, Debug)]
pub(super) struct Point {
    /// Pixel and scene.
    pub(super) group: u32,
    pub(super) block: u16,
    /// Time and scene.
    pub(super) level: u32,
    pub(super) ln_time: f64,
    pub(super) ln_amplitude: f64,
}

impl StillPixels {
    /// Fits the points of each pixel and scene.
    pub(super) fn fit(series: &[Vec<Point>], moved_fraction: f64) -> Outcome<Self> {
        let in_order = |points: &Vec<Point>| {
            let mut points = points.clone();
            points.sort_by(|a, b| a.ln_time.total_cmp(&b.ln_time));
            cut_over_saturation(&mut points);
            points
        };
        let series: Vec<Vec<Point>> = series.iter().map(in_order).collect();
        let points = below_compression(&series);
        let distinct =
            |of: fn(&Point) -> u32| points.iter().map(of).collect::<std::collections::HashSet<_>>().len();
        let (pixels, levels) = (distinct(|point| point.group), distinct(|point| point.level));
        let effect = effect(&points, levels)?;
        Ok(Self { effect, bands: bands(&series), pixels, levels, moved_fraction })
    }
}

fn effect(points: &[Point], levels: usize) -> Outcome<Effect> {
    let ways = if levels >= MINIMUM_FRAME_CLUSTERS { 2 } else { 1 };
    let mut regression = Regression::new(["integration time"], Intercepts::PerGroup);
    for point in points {
        let clusters = [u32::from(point.block), point.level];
        regression.push(Row {
            columns: &[point.ln_time],
            response: point.ln_amplitude,
            weight: 1.0,
            group: point.group,
            clusters: &clusters[..ways],
        })?;
    }
    let fit = regression.fit(Loss::Tukey)?;
    let exponent = Estimate::from(&fit.coefficients[0]);
    Ok(Effect {
        exponent,
        state: State::of_time(exponent),
        evidence: Evidence::StillPixels,
        residual: fit.residual_sigma,
        observations: fit.rows,
    })
}

/// Slopes between neighbouring times, by the amplitude between them.
fn bands(series: &[Vec<Point>]) -> Vec<Band> {
    let mut steps: Vec<(Point, Point)> = series.iter().flat_map(|points| steps(points)).collect();
    steps.sort_by(|a, b| middle(a).total_cmp(&middle(b)));
    let size = steps.len().div_ceil(BANDS).max(1);
    steps.chunks(size).filter(|steps| steps.len() >= MINIMUM_ROWS / BANDS).filter_map(band).collect()
}

/// The mean slope of steps that are sorted by amplitude.
fn band(steps: &[(Point, Point)]) -> Option<Band> {
    let mut regression = Regression::new(["integration time"], Intercepts::None);
    for (a, b) in steps {
        let (columns, response) = ([b.ln_time - a.ln_time], b.ln_amplitude - a.ln_amplitude);
        let clusters = [u32::from(a.block)];
        let row = Row { columns: &columns, response, weight: 1.0, group: 0, clusters: &clusters };
        regression.push(row).ok()?;
    }
    let fit = regression.fit(Loss::Tukey).ok()?;
    let amplitude_dn = middle(&steps[steps.len() / 2]).exp();
    Some(Band { amplitude_dn, exponent: Estimate::from(&fit.coefficients[0]) })
}

/// The logarithm of the amplitude in the middle of a step.
fn middle((a, b): &(Point, Point)) -> f64 {
    f64::midpoint(a.ln_amplitude, b.ln_amplitude)
}

/// Pairs of neighbouring points whose times are far enough apart.
fn steps(points: &[Point]) -> Vec<(Point, Point)> {
    let mut steps = Vec::new();
    let mut from = points.first().copied();
    for &point in points {
        if let Some(start) = from.filter(|start| point.ln_time - start.ln_time >= STEP_RATIO.ln()) {
            steps.push((start, point));
            from = Some(point);
        }
    }
    steps
}

/// Cuts a pixel's points behind its peak, if it rises to the peak and falls from it: over-saturation.
fn cut_over_saturation(points: &mut Vec<Point>) {
    let peak = (0..points.len()).max_by(|&a, &b| points[a].ln_amplitude.total_cmp(&points[b].ln_amplitude));
    let (Some(peak), Some(first), Some(last)) = (peak, points.first(), points.last()) else { return };
    let low = points[peak].ln_amplitude + OVER_SATURATED.ln();
    if first.ln_amplitude < low && last.ln_amplitude < low {
        points.truncate(peak + 1);
    }
}

/// The points below half of the large amplitudes, where they suffice; else all.
fn below_compression(series: &[Vec<Point>]) -> Vec<Point> {
    let pairs = |limit: f64| -> Vec<Point> {
        let below = |points: &Vec<Point>| -> Vec<Point> {
            points.iter().copied().filter(|point| point.ln_amplitude <= limit).collect()
        };
        series.iter().map(below).filter(|points| points.len() > 1).flatten().collect()
    };
    let all = pairs(f64::INFINITY);
    let mut ln_amplitudes: Vec<f64> = all.iter().map(|point| point.ln_amplitude).collect();
    let Some(large) = quantile(&mut ln_amplitudes, 0.995) else { return all };
    let below = pairs(large + LINEAR_SHARE.ln());
    if below.len() as f64 >= ENOUGH_SHARE * all.len() as f64 { below } else { all }
}
