//! Do amplitudes far below saturation grow in proportion to the integration time? If not, the gain drifts, or the times
//! are not those of the frames.

use super::frame_sums::{Times, kept};
use crate::calibrate::blocks::SIDE;
use crate::numerics::statistics::median;

/// A block is far below saturation while its amplitude is below this share of its largest: fill below 0.3 at least, of
/// which a soft well takes less than 1 %.
const LOW_SHARE: f64 = 0.25;
/// Amplitudes this many times above their noise are biased by 1/2 · 1/20², a thousandth.
const LEAST_SIGNAL_TO_NOISE: f64 = 20.0;
/// Blocks that two frames must share to be compared.
const LEAST_BLOCKS: usize = 6;

/// ln of the amplitude per time that blocks far below saturation share, for the number of each frame in the order of
/// time, up to a constant. `noise_dn` is the noise of a pixel at the shortest time.
pub(super) fn ln_rates(times: &Times, noise_dn: f64) -> Vec<(f64, f64)> {
    let frames = kept(times);
    let mean = |at: usize, block: usize| frames[at].1.blocks[block].mean_dn();
    let largest: Vec<f64> = (0..SIDE * SIDE)
        .map(|block| (0..frames.len()).map(|at| mean(at, block)).fold(0.0, f64::max))
        .collect();
    let ln_rate = |at: usize, block: usize| {
        let value = mean(at, block);
        let counts = value < LOW_SHARE * largest[block]
            && value > LEAST_SIGNAL_TO_NOISE * noise_dn
            && !frames[at].1.moved.contains(&block);
        counts.then(|| (value / frames[at].0).ln())
    };
    let (mut rates, mut level, mut last) = (Vec::new(), 0.0, None);
    for at in 0..frames.len() {
        let Some(before) = last.replace(at) else { continue };
        let changes =
            (0..SIDE * SIDE).filter_map(|block| Some(ln_rate(at, block)? - ln_rate(before, block)?));
        let mut changes: Vec<f64> = changes.collect();
        if changes.len() < LEAST_BLOCKS {
            // The blocks that count change with the time; where there are none, the chain ends.
            if rates.is_empty() {
                continue;
            }
            break;
        }
        if rates.is_empty() {
            rates.push((frames[before].1.number as f64, level));
        }
        level += median(&mut changes).unwrap_or(0.0);
        rates.push((frames[at].1.number as f64, level));
    }
    rates
}

/// The largest deviation from a constant rate, relative, with the sign of its change over the times. Two neighbouring
/// frames must agree on it.
pub(super) fn deviation(rates: &[(f64, f64)]) -> f64 {
    let pairs: Vec<f64> = rates.windows(2).map(|pair| 0.5 * (pair[0].1 + pair[1].1)).collect();
    let (least, most) =
        pairs.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(*v), b.max(*v)));
    match (pairs.first(), pairs.last()) {
        (Some(first), Some(last)) => (most - least).copysign(last - first).exp_m1(),
        _ => 0.0,
    }
}
