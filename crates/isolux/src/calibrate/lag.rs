//! Do the recorded integration times belong to other frames, some frames earlier or later?

use crate::numerics::statistics::{median_absolute_deviation, quantile};

/// What a sweep notes of a frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct Level {
    /// Integration time, µs; NaN where it is unknown.
    pub(super) time_us: f64,
    /// ln of the mean amplitude; −∞ for a black frame, NaN for one that is not measured.
    pub(super) ln_level: f64,
    /// Number of the place that the scene is in: levels of different places are not compared.
    pub(super) place: usize,
}

/// Times that are this many frames off are looked for.
const MOST_FRAMES: usize = 4;
/// Levels at one time that differ by more than this are suspicious.
const SUSPICIOUS: f64 = 0.03;
/// The differences must become so many times smaller with other times.
const CLEARER: f64 = 4.0;
/// Pairs of frames, or frames, that a judgement needs.
const LEAST: usize = 4;

/// By how many frames the times lag behind the frames (negative: run ahead of them); `None` where they do not, or it
/// cannot be told. `levels` in the order of recording.
pub(super) fn lag(levels: &[Level]) -> Option<isize> {
    let most = MOST_FRAMES as isize;
    let shifts = (1..=most).flat_map(|shift| [shift, -shift]);
    let by = |roughness: &dyn Fn(isize) -> Option<f64>| {
        let now = roughness(0).filter(|now| *now > SUSPICIOUS)?;
        let best = shifts.clone().filter_map(|shift| Some((shift, roughness(shift)?)));
        let (shift, least) = best.reduce(|best, next| if next.1 < 0.9 * best.1 { next } else { best })?;
        (least * CLEARER < now).then_some(shift)
    };
    let repeated = levels.windows(2).filter(|pair| pair[0].time_us == pair[1].time_us).count();
    if repeated >= LEAST { by(&|shift| repeats(levels, shift)) } else { by(&|shift| rates(levels, shift)) }
}

/// The frame whose time belongs to frame `index`.
fn shifted(levels: &[Level], index: usize, shift: isize) -> Option<f64> {
    levels.get(index.checked_add_signed(shift)?).map(|level| level.time_us)
}

/// How unlike consecutive levels at one time are: the 80 % quantile, because most pairs may be of one time even so.
fn repeats(levels: &[Level], shift: isize) -> Option<f64> {
    let pair = |index: usize| {
        let (a, b) = (levels.get(index)?, levels.get(index + 1)?);
        let one_time = shifted(levels, index, shift)? == shifted(levels, index + 1, shift)?;
        (one_time && a.place == b.place).then(|| (a.ln_level - b.ln_level).abs())
    };
    let mut differences: Vec<f64> =
        (0..levels.len()).filter_map(pair).filter(|d| !d.is_nan()).map(|d| d.min(1e3)).collect();
    if differences.len() < LEAST { None } else { quantile(&mut differences, 0.8) }
}

/// How unlike the levels per time are, over the shorter half of the times, where pixels are not yet full.
fn rates(levels: &[Level], shift: isize) -> Option<f64> {
    let mut times: Vec<f64> = levels.iter().map(|level| level.time_us).collect();
    let longest_us = quantile(&mut times, 0.5)?;
    let rate = |index: usize| {
        let time_us = shifted(levels, index, shift)?;
        let level = levels[index].ln_level;
        (time_us <= longest_us && level.is_finite()).then(|| level - time_us.ln())
    };
    let mut rates: Vec<f64> = (0..levels.len()).filter_map(rate).collect();
    if rates.len() < LEAST { None } else { median_absolute_deviation(&mut rates) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sweep(frames_per_time: usize) -> Vec<Level> {
        let times =
            [100.0f64, 150.0, 240.0, 300.0, 500.0, 560.0, 900.0, 1300.0, 1500.0, 2400.0, 2700.0, 4000.0];
        let frame = |time_us: f64| Level { time_us, ln_level: time_us.ln(), place: 0 };
        times.iter().flat_map(|time| vec![frame(*time); frames_per_time]).collect()
    }

    #[test]
    fn times_that_lag_or_run_ahead_are_found() {
        // Of pairs, one frame later is one time off one frame earlier: the sign cannot be told.
        for frames_per_time in [1, 3] {
            let right = sweep(frames_per_time);
            assert_eq!(lag(&right), None);
            let moved = |by: isize| -> Vec<Level> {
                let last = right.len() - 1;
                let from = |i: usize| i.saturating_add_signed(-by).min(last);
                (0..=last).map(|i| Level { time_us: right[from(i)].time_us, ..right[i] }).collect()
            };
            assert_eq!((lag(&moved(1)), lag(&moved(-1))), (Some(1), Some(-1)), "{frames_per_time}");
        }
    }

    #[test]
    fn a_single_stray_frame_is_no_lag() {
        let mut levels = sweep(3);
        levels[7].ln_level = f64::NEG_INFINITY;
        assert_eq!(lag(&levels), None);
    }
}
