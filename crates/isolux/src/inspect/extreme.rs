//! Codes and clips that nothing names: many pixels share an extreme value.

/// A value that fewer of the sampled pixels share may be chance.
const LEAST_COUNT: usize = 8;
/// ... or this share of them.
const LEAST_SHARE: f64 = 5e-4;
/// A measured value is followed closely by others. A code stands apart: nothing lies between it and the next, over this
/// share of the larger of the two.
const GAP_SHARE: f64 = 0.33;
/// ... for a value that is the largest of some number of bits, as most codes are, over this share.
const GAP_SHARE_OF_FULL_SCALE: f64 = 0.04;
/// The values from this fraction of the largest on say how many usually share one.
const TOP_SHARE: f64 = 0.8;
/// Where measurements clip, this many times as many pixels share the largest value, ...
const PILE_UP: f64 = 8.0;
/// ... and this share of all.
const LEAST_CLIPPED: f64 = 2e-3;

/// What an extreme value is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Kind {
    /// It stands apart: a code.
    Code,
    /// Others reach up to it: measurements end there.
    Clip,
}

/// An extreme value that many pixels share.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Extreme {
    pub(super) kind: Kind,
    pub(super) value: f32,
    /// Share of the values that are it, 0..=1.
    pub(super) share: f64,
    /// The nearest of the other values.
    pub(super) next: f32,
}

/// The largest of the values, where it is a code or they clip there. The values must be sorted.
pub(super) fn largest(sorted: &[f32]) -> Option<Extreme> {
    let value = *sorted.last()?;
    let others = &sorted[..sorted.partition_point(|&other| other < value)];
    let next = *others.last()?;
    let found = shared(sorted.len() - others.len(), sorted.len(), value, next)?;
    let gap_share = if is_full_scale(value) { GAP_SHARE_OF_FULL_SCALE } else { GAP_SHARE };
    if f64::from(value - next) > gap_share * f64::from(value) {
        return Some(Extreme { kind: Kind::Code, ..found });
    }
    let top = &others[others.partition_point(|&other| f64::from(other) < TOP_SHARE * f64::from(value))..];
    let levels = top.chunk_by(|a, b| a == b).count().max(1);
    let usual = top.len() as f64 / levels as f64;
    let clips =
        (sorted.len() - others.len()) as f64 > PILE_UP * usual.max(1.0) && found.share > LEAST_CLIPPED;
    clips.then_some(Extreme { kind: Kind::Clip, ..found })
}

/// The smallest of the values, where it is a code: nothing lies between it and the next. The values must be sorted.
pub(super) fn smallest(sorted: &[f32]) -> Option<Extreme> {
    let value = *sorted.first()?;
    let others = &sorted[sorted.partition_point(|&other| other <= value)..];
    let (next, median) = (*others.first()?, *others.get(others.len() / 2)?);
    let found = shared(sorted.len() - others.len(), sorted.len(), value, next)?;
    let apart = f64::from(next - value) > GAP_SHARE * f64::from(next)
        && f64::from(next - value) > GAP_SHARE_OF_FULL_SCALE * f64::from(median);
    apart.then_some(found)
}

/// The largest value of 8 to 24 bits, signed or not.
fn is_full_scale(value: f32) -> bool {
    (7..=24).any(|bits| value == ((1u32 << bits) - 1) as f32)
}

fn shared(count: usize, of: usize, value: f32, next: f32) -> Option<Extreme> {
    let share = count as f64 / of as f64;
    let many = count >= LEAST_COUNT && share >= LEAST_SHARE;
    many.then_some(Extreme { kind: Kind::Code, value, share, next })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 10 000 values from 100 to 2100, and `count` times `value`, sorted.
    fn values(value: f32, count: usize) -> Vec<f32> {
        let measured = (0..10_000).map(|i| (100 + i * 7919 % 2001) as f32);
        let mut values: Vec<f32> = measured.chain(std::iter::repeat_n(value, count)).collect();
        values.sort_unstable_by(f32::total_cmp);
        values
    }

    #[test]
    fn a_code_stands_apart_and_a_clip_does_not() {
        let code = largest(&values(4095.0, 50)).unwrap();
        assert_eq!((code.kind, code.value, code.next), (Kind::Code, 4095.0, 2100.0));
        assert_eq!(largest(&values(2100.0, 300)).unwrap().kind, Kind::Clip);
        let low = smallest(&values(1.0, 50)).unwrap();
        assert_eq!((low.value, low.next), (1.0, 100.0));
    }

    #[test]
    fn measurements_and_single_highlights_are_neither() {
        for (value, count) in [(500.0, 50), (2100.0, 20), (65535.0, 4)] {
            assert_eq!(largest(&values(value, count)), None, "{value} {count}");
            assert_eq!(smallest(&values(value, count)), None, "{value} {count}");
        }
        assert_eq!((largest(&[]), largest(&[3.0; 20])), (None, None));
    }
}
