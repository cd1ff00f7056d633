//! The factor that the still pixels of two frames share.

use super::look::{Grid, Look};
use crate::numerics::statistics::{SIGMA_PER_MAD, median, median_absolute_deviation};

/// A pixel stands still where its distance changes by less than this share and length: cameras shift their distances
/// with the exposure.
const STILL_SHARE: f32 = 0.01;
const STILL_M: f32 = 0.02;
/// Share of the bright pixels that must stand still.
const LEAST_SHARE: f64 = 0.25;
/// Pixels that tell the factor of a block, and blocks that tell that of the image.
const LEAST_PIXELS: usize = 6;
const LEAST_BLOCKS: usize = 6;
/// Blocks whose factors scatter by more (in ln) see different things.
const LARGEST_SCATTER: f64 = 0.2;
/// Nor is a factor of use whose standard error is larger.
const LARGEST_ERROR: f64 = 0.02;
/// Without distances, only the scene's own pattern tells that it stands still: the blocks' factors scatter by less
/// than this share of the blocks' brightness.
const PATTERN_SHARE: f64 = 0.25;

/// The factor that the still pixels of two frames share.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Pair {
    /// ln of the factor by which the second frame is brighter.
    pub(crate) ln_factor: f64,
    /// Robust standard deviation of the factor among the parts of the image, in ln.
    pub(crate) scatter: f64,
}

/// Compares two frames; `None` where too little stands still, or its parts do not agree. With `same_times`, only
/// pixels of one integration time are compared.
pub(crate) fn between(grid: Grid, reference: &Look, look: &Look, same_times: bool) -> Option<Pair> {
    let has_distance = !reference.distance_m.is_empty() && !look.distance_m.is_empty();
    let stands = |sample: usize| {
        let (one, other) = (reference.distance_m[sample], look.distance_m[sample]);
        (one - other).abs() <= STILL_SHARE * one + STILL_M
    };
    let (mut bright, mut ratios) = (0, Vec::new());
    for (sample, (&before, &after)) in reference.ln_values.iter().zip(&look.ln_values).enumerate() {
        // Dim pixels are noisy, and coarse in 8 bits. Both frames choose alike, or noise that makes a pixel bright in one
        // of them would make that frame brighter.
        if before + after >= reference.ln_middle + look.ln_middle {
            bright += 1;
            if (!same_times || reference.same_time(look, sample)) && (!has_distance || stands(sample)) {
                ratios.push((grid.block(sample), f64::from(after - before), f64::from(before)));
            }
        }
    }
    if (ratios.len() as f64) < LEAST_SHARE * f64::from(bright) {
        return None;
    }
    let ln_factor = median(&mut ratios.iter().map(|(_, ratio, _)| *ratio).collect::<Vec<_>>())?;
    let blocks = blocks(&mut ratios);
    if blocks.len() < LEAST_BLOCKS {
        return None;
    }
    let spread = |values: &mut Vec<f64>| Some(SIGMA_PER_MAD * median_absolute_deviation(values)?);
    let scatter = spread(&mut blocks.iter().map(|(ratio, _)| *ratio).collect())?;
    let pattern = spread(&mut blocks.iter().map(|(_, brightness)| *brightness).collect())?;
    // A median of n normal values has the standard error 1.25 σ / √n.
    let agree = scatter <= LARGEST_SCATTER && 1.25 * scatter <= LARGEST_ERROR * (blocks.len() as f64).sqrt();
    let recognised = has_distance || scatter <= PATTERN_SHARE * pattern;
    (agree && recognised).then_some(Pair { ln_factor, scatter })
}

/// Median ratio and median brightness (ln) of each block that has enough pixels.
fn blocks(ratios: &mut [(usize, f64, f64)]) -> Vec<(f64, f64)> {
    ratios.sort_by_key(|(block, ..)| *block);
    let of = |block: &[(usize, f64, f64)]| {
        let ratio = median(&mut block.iter().map(|(_, ratio, _)| *ratio).collect::<Vec<_>>())?;
        let brightness = median(&mut block.iter().map(|(.., brightness)| *brightness).collect::<Vec<_>>())?;
        Some((ratio, brightness))
    };
    let enough = |block: &&[(usize, f64, f64)]| block.len() >= LEAST_PIXELS;
    let mut found = Vec::with_capacity(Grid::BLOCKS);
    found.extend(ratios.chunk_by(|a, b| a.0 == b.0).filter(enough).filter_map(of));
    found
}
