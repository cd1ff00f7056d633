//! Sums of the same pixels at each integration time, and whether the scene before them has moved.

use super::limits::{MINIMUM_ROWS, SAME_TIME_RATIO};
use super::still::{Point, StillPixels};
use super::unavailable::{Outcome, Unavailable};
use crate::numerics::hash::splitmix64;
use crate::numerics::statistics::{SIGMA_PER_MAD, median, median_absolute_deviation};

/// Pixels that are followed.
const PIXELS: usize = 4096;
/// Most pairs of scene and integration time that are kept: 24 bytes for each followed pixel, 25 MB in all.
const LEVELS: usize = 256;
/// Most scenes (poses of what stands before a block) that are told apart.
const SCENES: usize = 16;
/// A block whose distances differ by more than this factor shows another scene: 5 % change the amplitude by 10 %.
const MOVED_RATIO: f64 = 1.05;
/// ... and by this many standard errors of the block's median: distances are noisy at short times.
const STANDARD_ERRORS: f64 = 4.0;
/// Standard error of a median per standard deviation and root of the count, √(π/2).
const MEDIAN_ERROR: f64 = 1.253_314_137_315_5;

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

/// The followed pixels (slots) of one scene at one time.
#[derive(Clone, Debug)]
struct Level {
    scene: usize,
    time_us: f32,
    cells: Vec<Cell>,
}

/// Follows a fixed sample of pixels. Scenes are numbered block by block, in the order in which they are met.
#[derive(Clone, Debug)]
pub(super) struct Panel {
    /// Index of each followed pixel and its image block, by block.
    pixels: Vec<(u32, u16)>,
    /// The distances at which each scene was first seen, by slot; NaN where it was not.
    scenes_m: Vec<Vec<f32>>,
    /// For each slot the number of scenes that its block has shown.
    scene_counts: Vec<usize>,
    levels: Vec<Level>,
    shortest_us: f32,
    longest_us: f32,
    seen: u64,
    moved: u64,
}

impl Panel {
    pub(super) fn new(pixels: usize, block: impl Fn(usize) -> u16) -> Self {
        let mut order: Vec<usize> = (0..pixels).collect();
        if pixels > PIXELS {
            order.select_nth_unstable_by_key(PIXELS, |&index| splitmix64(index as u64));
            order.truncate(PIXELS);
        }
        let mut pixels: Vec<(u32, u16)> =
            order.into_iter().map(|index| (index as u32, block(index))).collect();
        pixels.sort_unstable_by_key(|&(index, block)| (block, index));
        Self {
            scenes_m: Vec::new(),
            scene_counts: vec![0; pixels.len()],
            pixels,
            levels: Vec::new(),
            shortest_us: f32::INFINITY,
            longest_us: 0.0,
            seen: 0,
            moved: 0,
        }
    }

    /// Takes in a frame; `look` tells what it shows of a pixel, `None` where that is invalid.
    pub(super) fn push(&mut self, look: impl Fn(usize) -> Option<Look>) {
        let timed = |index: u32| look(index as usize).filter(|look| !look.time_us.is_nan());
        let looks: Vec<Option<Look>> = self.pixels.iter().map(|&(index, _)| timed(index)).collect();
        for look in looks.iter().flatten() {
            self.shortest_us = self.shortest_us.min(look.time_us);
            self.longest_us = self.longest_us.max(look.time_us);
        }
        let mut start = 0;
        while let Some(&(_, block)) = self.pixels.get(start) {
            let end = self.pixels.partition_point(|&(_, other)| other <= block);
            let shown = looks[start..end].iter().flatten().count() as u64;
            let scene = if shown > 0 { self.scene(start, &looks[start..end]) } else { None };
            self.seen += shown;
            self.moved += if scene == Some(0) { 0 } else { shown };
            if let Some(scene) = scene {
                (start..end).for_each(|slot| self.add(scene, slot, looks[slot]));
            }
            start = end;
        }
    }

    /// The scene that a block (the slots from `start` on) shows; `None` when there are too many.
    fn scene(&mut self, start: usize, looks: &[Option<Look>]) -> Option<usize> {
        let known = self.scene_counts[start];
        if let Some(scene) = (0..known).find(|&scene| !has_moved(&self.scenes_m[scene][start..], looks)) {
            return Some(scene);
        }
        if known == SCENES {
            return None;
        }
        if self.scenes_m.len() == known {
            self.scenes_m.push(vec![f32::NAN; self.pixels.len()]);
        }
        self.scene_counts[start..start + looks.len()].fill(known + 1);
        Some(known)
    }

    fn add(&mut self, scene: usize, slot: usize, look: Option<Look>) {
        let Some(Look { time_us, amplitude, distance_m }) = look else { return };
        let first_m = &mut self.scenes_m[scene][slot];
        if first_m.is_nan() {
            *first_m = distance_m;
        }
        let Some(level) = self.level(scene, time_us) else { return };
        let cell = &mut self.levels[level].cells[slot];
        cell.sum_ln_amplitude += f64::from(amplitude).ln();
        cell.sum_ln_time += f64::from(time_us).ln();
        cell.largest = cell.largest.max(amplitude);
        cell.count = cell.count.saturating_add(1);
    }

    /// The level of this scene and time; that of the nearest time when there are too many.
    fn level(&mut self, scene: usize, time_us: f32) -> Option<usize> {
        let nearest = (self.levels.iter().enumerate())
            .filter(|(_, level)| level.scene == scene)
            .map(|(index, level)| (index, f64::from(level.time_us / time_us).ln().abs()))
            .min_by(|a, b| a.1.total_cmp(&b.1));
        match nearest {
            Some((index, apart)) if apart < SAME_TIME_RATIO.ln() => Some(index),
            _ if self.levels.len() >= LEVELS => nearest.map(|(index, _)| index),
            _ => {
                self.levels.push(Level { scene, time_us, cells: vec![Cell::default(); self.pixels.len()] });
                Some(self.levels.len() - 1)
            }
        }
    }

    /// The exponent of t. Values at or above `clip_dn` do not enter.
    pub(super) fn finish(&self, clip_dn: f32, time_per_pixel: bool) -> Outcome<StillPixels> {
        if self.seen == 0 {
            return Err(Unavailable::TimeUnknown);
        }
        if f64::from(self.longest_us) < SAME_TIME_RATIO * f64::from(self.shortest_us) {
            return Err(Unavailable::TimeConstant { time_us: f64::from(self.longest_us) });
        }
        let series = self.series(clip_dn);
        let repeated = series.iter().filter(|points| points.len() > 1).map(Vec::len).sum::<usize>();
        let moved_fraction = self.moved as f64 / self.seen as f64;
        if repeated < MINIMUM_ROWS {
            return Err(match (time_per_pixel, self.moved) {
                (true, _) => Unavailable::TimeFollowsMaterial,
                (false, 0) => Unavailable::TooFewPixels { found: repeated, needed: MINIMUM_ROWS },
                (false, _) => Unavailable::SceneMoved { share: moved_fraction },
            });
        }
        StillPixels::fit(&series, moved_fraction)
    }

    /// The points of each pixel in each scene, without clipped ones.
    fn series(&self, clip_dn: f32) -> Vec<Vec<Point>> {
        let mut series = vec![Vec::new(); self.scenes_m.len() * self.pixels.len()];
        for (number, level) in self.levels.iter().enumerate() {
            for (slot, cell) in level.cells.iter().enumerate() {
                let count = f64::from(cell.count);
                if cell.count > 0 && cell.largest < clip_dn {
                    let group = level.scene * self.pixels.len() + slot;
                    series[group].push(Point {
                        group: group as u32,
                        block: self.pixels[slot].1,
                        level: number as u32,
                        ln_time: cell.sum_ln_time / count,
                        ln_amplitude: cell.sum_ln_amplitude / count,
                    });
                }
            }
        }
        series
    }
}

/// True when the distances of a block's pixels are not those at which the scene was first seen.
fn has_moved(first_m: &[f32], looks: &[Option<Look>]) -> bool {
    let ln_ratio = |(look, first_m): (&Option<Look>, &f32)| {
        look.map(|look| f64::from(look.distance_m / first_m).ln()).filter(|ratio| ratio.is_finite())
    };
    let mut ratios: Vec<f64> = looks.iter().zip(first_m).filter_map(ln_ratio).collect();
    let count = ratios.len() as f64;
    let Some(shift) = median(&mut ratios) else { return false };
    let sigma = SIGMA_PER_MAD * median_absolute_deviation(&mut ratios).unwrap_or(0.0);
    shift.abs() > MOVED_RATIO.ln() + STANDARD_ERRORS * MEDIAN_ERROR * sigma / count.sqrt()
}
