//! The same pixels at several integration times: their material and distance cancel.

use serde::Serialize;

use super::effect::{Effect, Estimate, Evidence, State};
use super::untold::{Outcome, Untold};
use super::{MINIMUM_FRAME_CLUSTERS, MINIMUM_ROWS, SAME_TIME_RATIO, hash};
use crate::regression::{Intercepts, Loss, Regression, Row};
use crate::statistics::{SIGMA_PER_MAD, median, median_absolute_deviation, quantile};

/// Pixels that are followed.
const PIXELS: usize = 4096;
/// Most integration times that are told apart; further ones join the nearest.
const LEVELS: usize = 256;
/// A block whose distances differ by more than this factor shows another scene: 5 % change the amplitude by 10 %.
const MOVED_RATIO: f64 = 1.05;
/// ... and by this many standard errors of the block's median: distances are noisy at short times.
const STANDARD_ERRORS: f64 = 4.0;
/// Standard error of a median per standard deviation and root of the count, √(π/2).
const MEDIAN_ERROR: f64 = 1.253_314_137_315_5;
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
    /// Pixels that were followed and entered.
    pub pixels: usize,
    /// Integration times that were told apart.
    pub times: usize,
    /// Share of the followed values that were left out because the distances around them had changed, 0..=1.
    pub moved_fraction: f64,
}

#[derive(Clone, Copy, Debug, Default)]
struct Cell {
    sum_ln_amplitude: f64,
    sum_ln_time: f64,
    largest: f32,
    count: u32,
}

/// What a frame shows of a pixel; NaN for an unknown time or distance.
#[derive(Clone, Copy, Debug)]
pub(super) struct Look {
    pub(super) time_us: f32,
    pub(super) amplitude: f32,
    pub(super) distance_m: f32,
}

/// Sums of the followed pixels (slots) at each time (level).
#[derive(Clone, Debug)]
pub(super) struct Panel {
    /// Index of each followed pixel and its image block, by block.
    pixels: Vec<(u32, u16)>,
    first_distance_m: Vec<f32>,
    levels: Vec<(f32, Vec<Cell>)>,
    seen: u64,
    moved: u64,
}

/// One pixel at one time.
#[derive(Clone, Copy, Debug)]
struct Point {
    slot: usize,
    level: usize,
    ln_time: f64,
    ln_amplitude: f64,
}

impl Panel {
    pub(super) fn new(pixels: usize, block: impl Fn(usize) -> u16) -> Self {
        let mut order: Vec<usize> = (0..pixels).collect();
        if pixels > PIXELS {
            order.select_nth_unstable_by_key(PIXELS, |&index| hash(index as u64));
            order.truncate(PIXELS);
        }
        let mut pixels: Vec<(u32, u16)> =
            order.into_iter().map(|index| (index as u32, block(index))).collect();
        pixels.sort_unstable_by_key(|&(index, block)| (block, index));
        let first_distance_m = vec![f32::NAN; pixels.len()];
        Self { pixels, first_distance_m, levels: Vec::new(), seen: 0, moved: 0 }
    }

    /// Takes in a frame; `look` tells what it shows of a pixel, `None` where that is invalid.
    pub(super) fn push(&mut self, look: impl Fn(usize) -> Option<Look>) {
        let timed = |index: u32| look(index as usize).filter(|look| !look.time_us.is_nan());
        let looks: Vec<Option<Look>> = self.pixels.iter().map(|&(index, _)| timed(index)).collect();
        let mut start = 0;
        while let Some(&(_, block)) = self.pixels.get(start) {
            let end = self.pixels.partition_point(|&(_, other)| other <= block);
            let shown = looks[start..end].iter().flatten().count() as u64;
            self.seen += shown;
            if self.has_moved(start, &looks[start..end]) {
                self.moved += shown;
            } else {
                (start..end).for_each(|slot| self.add(slot, looks[slot]));
            }
            start = end;
        }
    }

    /// True when the distances of a block (the slots from `start` on) are not those that were seen first.
    fn has_moved(&self, start: usize, looks: &[Option<Look>]) -> bool {
        let first = &self.first_distance_m[start..];
        let ln_ratio = |(look, first): (&Option<Look>, &f32)| {
            look.map(|look| f64::from(look.distance_m / first).ln()).filter(|ratio| ratio.is_finite())
        };
        let mut ratios: Vec<f64> = looks.iter().zip(first).filter_map(ln_ratio).collect();
        let count = ratios.len() as f64;
        let Some(shift) = median(&mut ratios) else { return false };
        let sigma = SIGMA_PER_MAD * median_absolute_deviation(&mut ratios).unwrap_or(0.0);
        shift.abs() > MOVED_RATIO.ln() + STANDARD_ERRORS * MEDIAN_ERROR * sigma / count.sqrt()
    }

    fn add(&mut self, slot: usize, look: Option<Look>) {
        let Some(Look { time_us, amplitude, distance_m }) = look else { return };
        if self.first_distance_m[slot].is_nan() {
            self.first_distance_m[slot] = distance_m;
        }
        let level = self.level(time_us);
        let cell = &mut self.levels[level].1[slot];
        cell.sum_ln_amplitude += f64::from(amplitude).ln();
        cell.sum_ln_time += f64::from(time_us).ln();
        cell.largest = cell.largest.max(amplitude);
        cell.count = cell.count.saturating_add(1);
    }

    /// The level of this time, or the nearest one when there are too many.
    fn level(&mut self, time_us: f32) -> usize {
        let apart = |level: f32| f64::from(level / time_us).ln().abs();
        let nearest = (self.levels.iter().enumerate())
            .map(|(index, (level, _))| (index, apart(*level)))
            .min_by(|a, b| a.1.total_cmp(&b.1));
        match nearest {
            Some((index, apart)) if apart < SAME_TIME_RATIO.ln() || self.levels.len() >= LEVELS => index,
            _ => {
                self.levels.push((time_us, vec![Cell::default(); self.first_distance_m.len()]));
                self.levels.len() - 1
            }
        }
    }

    /// The exponent of t. Values at or above `clip_dn` do not enter.
    pub(super) fn finish(&self, clip_dn: f32, time_per_pixel: bool) -> Outcome<StillPixels> {
        let moved_fraction = self.moved as f64 / self.seen.max(1) as f64;
        match self.levels.as_slice() {
            [] => return Err(Untold::TimeUnknown),
            [(time_us, _)] if self.moved == 0 => {
                return Err(Untold::TimeConstant { time_us: f64::from(*time_us) });
            }
            _ => {}
        }
        let series = self.series(clip_dn);
        let points = below_compression(&series);
        if points.len() < MINIMUM_ROWS {
            return Err(match (time_per_pixel, self.moved) {
                (true, _) => Untold::TimeFollowsMaterial,
                (false, 0) => Untold::TooFewPixels { found: points.len(), needed: MINIMUM_ROWS },
                (false, _) => Untold::SceneMoved { share: moved_fraction },
            });
        }
        let mut pixels: Vec<usize> = points.iter().map(|point| point.slot).collect();
        pixels.dedup();
        Ok(StillPixels {
            effect: self.effect(&points)?,
            bands: self.bands(&series),
            pixels: pixels.len(),
            times: self.levels.len(),
            moved_fraction,
        })
    }

    /// The points of each pixel by time, without clipped and over-saturated ones.
    fn series(&self, clip_dn: f32) -> Vec<Vec<Point>> {
        let point = |slot: usize, level: usize| {
            let cell = &self.levels[level].1[slot];
            let count = f64::from(cell.count);
            let (ln_time, ln_amplitude) = (cell.sum_ln_time / count, cell.sum_ln_amplitude / count);
            (cell.count > 0 && cell.largest < clip_dn).then_some(Point { slot, level, ln_time, ln_amplitude })
        };
        let of_pixel = |slot: usize| {
            let mut points: Vec<Point> =
                (0..self.levels.len()).filter_map(|level| point(slot, level)).collect();
            points.sort_by(|a, b| a.ln_time.total_cmp(&b.ln_time));
            cut_over_saturation(&mut points);
            points
        };
        (0..self.pixels.len()).map(of_pixel).collect()
    }

    fn effect(&self, points: &[Point]) -> Outcome<Effect> {
        let by_time = self.levels.len() >= MINIMUM_FRAME_CLUSTERS;
        let mut regression = Regression::new(["integration time"], Intercepts::PerGroup);
        for point in points {
            let clusters = [u32::from(self.pixels[point.slot].1), point.level as u32];
            regression.push(Row {
                columns: &[point.ln_time],
                response: point.ln_amplitude,
                weight: 1.0,
                group: point.slot as u32,
                clusters: &clusters[..if by_time { 2 } else { 1 }],
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
    fn bands(&self, series: &[Vec<Point>]) -> Vec<Band> {
        let mut steps: Vec<(Point, Point)> = series.iter().flat_map(|points| steps(points)).collect();
        let middle = |(a, b): &(Point, Point)| f64::midpoint(a.ln_amplitude, b.ln_amplitude);
        steps.sort_by(|a, b| middle(a).total_cmp(&middle(b)));
        let size = steps.len().div_ceil(BANDS).max(1);
        let band = |steps: &[(Point, Point)]| {
            let mut regression = Regression::new(["integration time"], Intercepts::None);
            for (a, b) in steps {
                let clusters = [u32::from(self.pixels[a.slot].1)];
                let (columns, response) = ([b.ln_time - a.ln_time], b.ln_amplitude - a.ln_amplitude);
                let row = Row { columns: &columns, response, weight: 1.0, group: 0, clusters: &clusters };
                regression.push(row).ok()?;
            }
            let fit = regression.fit(Loss::Tukey).ok()?;
            let amplitude_dn = middle(&steps[steps.len() / 2]).exp();
            Some(Band { amplitude_dn, exponent: Estimate::from(&fit.coefficients[0]) })
        };
        let bands = steps.chunks(size).filter(|steps| steps.len() >= MINIMUM_ROWS / BANDS);
        bands.filter_map(band).collect()
    }
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
