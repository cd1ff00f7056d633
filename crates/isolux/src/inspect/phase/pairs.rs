//! Which bins are opposite: their sums tell, whatever the scene.

use super::sample::Pixel;
use super::turn::Pairs;
use crate::numerics::statistics::{median, quantile};

/// Sums of opposite bins differ by noise alone: by less than this share of the amplitude in pixels that are not dark ...
const BALANCED: f64 = 0.2;
/// ... and those of bins that are not by more than this one.
const UNBALANCED: f64 = 0.5;
/// ... and by so many times the first.
const CLEARLY: f64 = 4.0;
/// Share of the pixels, the brightest ones, that are looked at: the others are noisy.
const BRIGHTEST: f64 = 0.5;

/// Which bins are opposite, and how well their sums agree.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Opposites {
    pub(super) pairs: Pairs,
    /// Typical difference of the sums as the bins are read, relative to the amplitude.
    pub(super) stated: f64,
    /// The same with `pairs`.
    pub(super) found: f64,
}

/// The bins that are opposite, where they are others than those that are read as such.
pub(super) fn misread(pixels: &[Pixel]) -> Option<Opposites> {
    let others = Pairs::ALL.into_iter().skip(1);
    let mut found: Vec<(f64, Pairs)> =
        others.filter_map(|pairs| Some((imbalance(pixels, pairs, pairs)?, pairs))).collect();
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    let [(found, pairs), (second, _)] = found[..] else { return None };
    let stated = imbalance(pixels, Pairs::STATED, pairs)?;
    // A wall at a phase of 45° has two ways that balance: neither is sure then.
    let sure = found < BALANCED && second > UNBALANCED && second > CLEARLY * found;
    let contradicted = stated > UNBALANCED && stated > CLEARLY * found;
    (sure && contradicted).then_some(Opposites { pairs, stated, found })
}

/// Median difference of the sums, relative to the amplitude if those of `opposite` are, of the brighter pixels.
fn imbalance(pixels: &[Pixel], pairs: Pairs, opposite: Pairs) -> Option<f64> {
    let amplitude = |pixel: &Pixel| {
        let [cosine, sine] = opposite.differences(pixel.bins);
        0.5 * cosine.hypot(sine)
    };
    let mut amplitudes: Vec<f64> = pixels.iter().map(amplitude).collect();
    let enough = quantile(&mut amplitudes, 1.0 - BRIGHTEST)?;
    let bright = pixels.iter().filter(|pixel| amplitude(pixel) >= enough && amplitude(pixel) > 0.0);
    let mut shares: Vec<f64> =
        bright.map(|pixel| pairs.imbalance(pixel.bins).abs() / amplitude(pixel)).collect();
    median(&mut shares)
}
