//! Phase samples that clip at a value which nothing names.

/// Bins that share a value by chance are fewer.
const SHARED_BINS: usize = 8;
/// ... and fewer than this share.
const SHARED_SHARE: f64 = 5e-4;
/// Where bins do not clip, no value is taken by more of them than all within this share below it ...
const NEIGHBOURS: f64 = 0.02;
/// ... times this,
const PILED: usize = 2;
/// and than so many times what a value is taken by on average: a scene without noise repeats its values.
const REPEATED: usize = 4;

/// The value at which bins clip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Clip {
    /// The value, DN, positive.
    pub(super) value_dn: f32,
    /// Share of the bins that have it, or its negative, 0..=1.
    pub(super) share: f64,
    /// True where bins clip at the negative value too.
    pub(super) both_signs: bool,
}

/// The value at which bins clip, where they do. Bins of a difference image clip at the bottom, too.
pub(super) fn clip(bins: impl Iterator<Item = [f32; 4]>) -> Option<Clip> {
    let mut values: Vec<f32> = bins.flatten().collect();
    values.sort_unstable_by(f32::total_cmp);
    let distinct = values.chunk_by(|a, b| a == b).count();
    let repeats = values.len() / distinct.max(1);
    let top = pile(values.iter().rev().copied(), values.len(), repeats);
    let bottom = pile(values.iter().map(|value| -value), values.len(), repeats);
    let share = |count: usize| count as f64 / values.len() as f64;
    let (top, bottom) = (top.filter(|pile| pile.0 > 0.0), bottom.filter(|pile| pile.0 > 0.0));
    match (top, bottom) {
        (Some((high, some)), Some((low, more))) => {
            Some(Clip { value_dn: high.min(low), share: share(some + more), both_signs: true })
        }
        (Some((value_dn, count)), None) | (None, Some((value_dn, count))) => {
            Some(Clip { value_dn, share: share(count), both_signs: false })
        }
        (None, None) => None,
    }
}

/// The first of the descending `values` and how many have it, where these are so many that it is where bins clip.
fn pile(values: impl Iterator<Item = f32> + Clone, all: usize, repeats: usize) -> Option<(f32, usize)> {
    let value = values.clone().next()?;
    let count = values.clone().take_while(|&other| other == value).count();
    let near = value - (NEIGHBOURS as f32 * value.abs()).max(2.0);
    let neighbours = values.skip(count).take_while(|&other| other >= near).count();
    let piled = count > PILED * neighbours && count > REPEATED * repeats;
    (piled && count >= SHARED_BINS && count as f64 >= SHARED_SHARE * all as f64).then_some((value, count))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Bins of a slope that rises to 1.25 times `clip`, over whole numbers, with all values taken.
    fn slope(clip: f32, low: f32) -> impl Iterator<Item = [f32; 4]> {
        (0..2000).map(move |step| {
            let value = step as f32 * clip / 1600.0;
            [value, 0.3 * value, -value, 0.1 * value].map(|bin: f32| bin.round().clamp(low, clip))
        })
    }

    #[test]
    fn a_pile_at_the_end_is_a_clip_on_either_side() {
        let both = clip(slope(2047.0, -2047.0)).unwrap();
        assert_eq!((both.value_dn, both.both_signs), (2047.0, true));
        assert!((both.share - 0.1).abs() < 0.002, "{}", both.share);
        // Two's complement reaches one step further down: the smaller value holds for both.
        assert_eq!(clip(slope(2047.0, -2048.0)).unwrap().value_dn, 2047.0);
        let top = clip(slope(1000.0, -1e9)).unwrap();
        assert_eq!((top.value_dn, top.both_signs), (1000.0, false));
    }

    #[test]
    fn values_that_merely_end_are_none() {
        assert_eq!(clip((0..2000).map(|step| [step as f32, 7.0, 3.0, 5.0 + 0.5 * step as f32])), None);
        // The few values of a dark image, and one without noise.
        assert_eq!(clip((0..2000).map(|step| [100.0 + (step % 3) as f32; 4])), None);
        assert_eq!(clip((0..2000).map(|_| [900.0, 400.0, 100.0, 600.0])), None);
        // Pixels that do not work are 0.
        let dead = |step: usize| if step.is_multiple_of(20) { [0.0; 4] } else { [100.0 + step as f32; 4] };
        assert_eq!(clip((0..2000).map(dead)), None);
        assert_eq!(clip(std::iter::empty()), None);
    }
}
