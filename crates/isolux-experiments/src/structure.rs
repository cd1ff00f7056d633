//! How much structure of an image survives a correction (methods, section 6): ratio of the deviations,
//! correlation of the gradients, rank correlation.

use isolux::Plane;

/// What is left of the structure within a part of an image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Structure {
    /// Standard deviation after / before.
    pub(crate) deviation_ratio: f64,
    /// Correlation of the differences between neighbours before and after; 0 where one image has none left.
    pub(crate) gradient_correlation: f64,
    /// Kendall's τ-b between the values before and after; 0 where one image has one value only.
    pub(crate) kendall_tau: f64,
}

/// Compares `after` with `before` on the pixels of `part` (row by row, true = belongs to it). Pixels that are
/// not finite in either image are left out. All three planes have one shape.
pub(crate) fn kept(before: &Plane<f32>, after: &Plane<f32>, part: &[bool]) -> Structure {
    let value = |index: usize| {
        let pair = (f64::from(before.values()[index]), f64::from(after.values()[index]));
        (part[index] && pair.0.is_finite() && pair.1.is_finite()).then_some(pair)
    };
    let values: Vec<(f64, f64)> = (0..part.len()).filter_map(value).collect();
    let shape = before.shape();
    let mut steps = Vec::new();
    for index in 0..part.len() {
        let Some(here) = value(index) else { continue };
        let right = Some(index + 1).filter(|right| !right.is_multiple_of(shape.width));
        let below = Some(index + shape.width).filter(|below| *below < part.len());
        for neighbour in [right, below].into_iter().flatten().filter_map(value) {
            steps.push((neighbour.0 - here.0, neighbour.1 - here.1));
        }
    }
    let [variance_before, _, variance_after] = second_moments(&values);
    let [steps_before, steps_both, steps_after] = second_moments(&steps);
    Structure {
        deviation_ratio: (variance_after / variance_before).sqrt(),
        gradient_correlation: over_root(steps_both, steps_before, steps_after),
        kendall_tau: kendall_tau(values),
    }
}

/// Central moments xx, xy, yy.
fn second_moments(pairs: &[(f64, f64)]) -> [f64; 3] {
    let count = pairs.len() as f64;
    let (x_sum, y_sum) = pairs.iter().fold((0.0, 0.0), |(x_sum, y_sum), (x, y)| (x_sum + x, y_sum + y));
    let (x_mean, y_mean) = (x_sum / count, y_sum / count);
    pairs.iter().fold([0.0; 3], |[xx, xy, yy], (x, y)| {
        let (x, y) = (x - x_mean, y - y_mean);
        [xx + x * x / count, xy + x * y / count, yy + y * y / count]
    })
}

/// `numerator / √(a b)`, 0 where that is not defined.
fn over_root(numerator: f64, a: f64, b: f64) -> f64 {
    let product = a * b;
    if product > 0.0 { numerator / product.sqrt() } else { 0.0 }
}

/// Kendall's τ-b of (x, y) pairs in O(n log n) (Knight, "A Computer Method for Calculating Kendall's Tau with
/// Ungrouped Data", JASA 1966): the exchanges that sorting by y needs after sorting by x are the discordant pairs.
fn kendall_tau(mut pairs: Vec<(f64, f64)>) -> f64 {
    let all = pairs_of(pairs.len());
    pairs.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    let equal_x = equal_pairs(&pairs, |a, b| a.0 == b.0);
    let equal_both = equal_pairs(&pairs, |a, b| a == b);
    let mut y: Vec<f64> = pairs.iter().map(|pair| pair.1).collect();
    let discordant = sort_counting(&mut y, &mut vec![0.0; pairs.len()]);
    let equal_y = equal_pairs(&y, |a, b| a == b);
    let concordant_less_discordant = all - equal_x - equal_y + equal_both - 2.0 * discordant;
    over_root(concordant_less_discordant, all - equal_x, all - equal_y)
}

fn pairs_of(count: usize) -> f64 {
    0.5 * count as f64 * (count as f64 - 1.0)
}

/// Number of pairs of equal neighbours in a sorted list.
fn equal_pairs<T>(sorted: &[T], equal: impl FnMut(&T, &T) -> bool) -> f64 {
    sorted.chunk_by(equal).map(|run| pairs_of(run.len())).sum()
}

/// Merge sort; returns the number of pairs that stood in the wrong order.
fn sort_counting(values: &mut [f64], memory: &mut [f64]) -> f64 {
    let (count, middle) = (values.len(), values.len() / 2);
    if count < 2 {
        return 0.0;
    }
    let (left, right) = values.split_at_mut(middle);
    let (left_memory, right_memory) = memory.split_at_mut(middle);
    let mut exchanged = sort_counting(left, left_memory) + sort_counting(right, right_memory);
    memory.copy_from_slice(values);
    let (mut i, mut j) = (0, middle);
    for slot in values.iter_mut() {
        if j == count || (i < middle && memory[i] <= memory[j]) {
            *slot = memory[i];
            i += 1;
        } else {
            *slot = memory[j];
            exchanged += (middle - i) as f64;
            j += 1;
        }
    }
    exchanged
}

#[cfg(test)]
mod tests {
    use super::*;
    use isolux::Shape;

    /// By its definition, over all pairs.
    fn naive_tau(pairs: &[(f64, f64)]) -> f64 {
        let (mut score, mut x_untied, mut y_untied) = (0.0, 0.0, 0.0);
        for (i, a) in pairs.iter().enumerate() {
            for b in &pairs[i + 1..] {
                let sign = |step: f64| if step == 0.0 { 0.0 } else { step.signum() };
                let (x, y) = (sign(a.0 - b.0), sign(a.1 - b.1));
                score += x * y;
                x_untied += x * x;
                y_untied += y * y;
            }
        }
        score / f64::sqrt(x_untied * y_untied)
    }

    /// Values that repeat, in no order (a multiplicative generator modulo a prime).
    fn scattered(count: usize, distinct: u64) -> Vec<(f64, f64)> {
        let mut state = 7;
        let mut next = || {
            state = state * 16_807 % 2_147_483_647;
            (state % distinct) as f64
        };
        (0..count).map(|_| (next(), next())).collect()
    }

    #[test]
    fn tau_is_that_of_the_definition_with_and_without_ties() {
        for (count, distinct) in [(2, 100), (57, 4), (200, 30), (333, 1_000_000)] {
            let pairs = scattered(count, distinct);
            // All counts are whole numbers: only the root and the quotient round.
            assert!((kendall_tau(pairs.clone()) - naive_tau(&pairs)).abs() < 4.0 * f64::EPSILON, "{count}");
        }
    }

    #[test]
    fn tau_of_an_order_that_stays_turns_or_is_lost() {
        let line = |y: fn(f64) -> f64| (0..50).map(|i| (f64::from(i), y(f64::from(i)))).collect::<Vec<_>>();
        assert_eq!(kendall_tau(line(f64::exp)), 1.0);
        assert_eq!(kendall_tau(line(|x| -x)), -1.0);
        assert_eq!(kendall_tau(line(|_| 3.0)), 0.0);
        assert_eq!(kendall_tau(Vec::new()), 0.0);
    }

    #[test]
    fn a_gain_keeps_all_and_a_constant_nothing_of_the_part_alone() {
        let shape = Shape::new(4, 5);
        let before = Plane::from_fn(shape, |row, column| ((3 * row + 7 * column) % 11) as f32);
        let mut after = before.clone();
        after.values_mut().iter_mut().for_each(|value| *value *= 0.5);
        // Outside the part, and where there is no value, nothing counts.
        after.values_mut()[0] = 1e6;
        after.values_mut()[7] = f32::NAN;
        let part: Vec<bool> = (0..20).map(|index| index != 0).collect();
        let same = kept(&before, &after, &part);
        assert_eq!(same.deviation_ratio, 0.5);
        assert_eq!(same.kendall_tau, 1.0);
        assert!((same.gradient_correlation - 1.0).abs() < 1e-12);
        let flat = kept(&before, &Plane::filled(shape, 4.0), &part);
        assert_eq!(flat, Structure { deviation_ratio: 0.0, gradient_correlation: 0.0, kendall_tau: 0.0 });
    }

    #[test]
    fn the_last_column_is_no_neighbour_of_the_next_row() {
        let shape = Shape::new(2, 2);
        // Steps by hand: right 1→2, 4→8; below 1→4, 2→8.
        let before = Plane::from_vec(shape, vec![1.0, 2.0, 4.0, 8.0]).unwrap();
        let after = Plane::from_vec(shape, vec![1.0, 2.0, 4.0, 4.0]).unwrap();
        let found = kept(&before, &after, &[true; 4]).gradient_correlation;
        let (x, y) = ([1.0, 4.0, 3.0, 6.0], [1.0, 0.0, 3.0, 2.0f64]);
        let (x_mean, y_mean) = (3.5, 1.5);
        let moment = |a: [f64; 4], a_mean: f64, b: [f64; 4], b_mean: f64| -> f64 {
            a.iter().zip(b).map(|(a, b)| (a - a_mean) * (b - b_mean)).sum()
        };
        let expected = moment(x, x_mean, y, y_mean)
            / (moment(x, x_mean, x, x_mean) * moment(y, y_mean, y, y_mean)).sqrt();
        assert!((found - expected).abs() < 1e-12, "{found} {expected}");
    }
}
