//! Small robust statistics in f64, shared by the fits and the evaluation.
//!
//! Slices hold valid, finite values: callers leave invalid pixels out. Functions that take `&mut [f64]` reorder
//! or overwrite the slice instead of copying it. What cannot be computed is `None`, never 0 or NaN.

/// Standard deviation of a normal distribution per median absolute deviation, 1/Φ⁻¹(3/4).
pub const SIGMA_PER_MAD: f64 = 1.482_602_218_505_602;

/// Normal quantile of a two-sided 95 % interval.
pub(crate) const Z_95: f64 = 1.959_963_984_540_054;

/// The `fraction` quantile (0..=1) with linear interpolation between order statistics, definition 7 of Hyndman
/// and Fan (1996), as NumPy's default. Reorders `values`. `None` for an empty slice or a fraction outside 0..=1.
#[must_use]
pub fn quantile(values: &mut [f64], fraction: f64) -> Option<f64> {
    if values.is_empty() || !(0.0..=1.0).contains(&fraction) {
        return None;
    }
    let position = fraction * (values.len() - 1) as f64;
    let lower = position.floor() as usize;
    let weight = position - position.floor();
    let (_, &mut at_lower, above) = values.select_nth_unstable_by(lower, f64::total_cmp);
    let at_upper = above.iter().copied().min_by(f64::total_cmp).unwrap_or(at_lower);
    Some(if weight == 0.0 { at_lower } else { at_lower + weight * (at_upper - at_lower) })
}

/// The median; the mean of the middle two for an even count. Reorders `values`.
#[must_use]
pub fn median(values: &mut [f64]) -> Option<f64> {
    quantile(values, 0.5)
}

/// The median; the upper of the middle two for an even count, so that it is one of the values. Reorders `values`.
#[must_use]
pub fn upper_median(values: &mut [f64]) -> Option<f64> {
    let middle = values.len() / 2;
    (middle < values.len()).then(|| *values.select_nth_unstable_by(middle, f64::total_cmp).1)
}

/// The median absolute deviation from the median, in the unit of `values`, which are overwritten. Times
/// [`SIGMA_PER_MAD`] it estimates σ.
#[must_use]
pub fn median_absolute_deviation(values: &mut [f64]) -> Option<f64> {
    let centre = median(values)?;
    values.iter_mut().for_each(|value| *value = (*value - centre).abs());
    median(values)
}

/// Running mean and variance (Welford 1962): one pass, no cancellation.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Moments {
    count: u32,
    mean: f64,
    squares: f64,
}

impl Moments {
    /// Takes one more value in.
    pub(crate) fn push(&mut self, value: f64) {
        self.count = self.count.saturating_add(1);
        let step = value - self.mean;
        self.mean += step / f64::from(self.count);
        self.squares += step * (value - self.mean);
    }

    /// Number of values.
    pub(crate) fn count(&self) -> u32 {
        self.count
    }

    /// Mean of the values, in their unit.
    pub(crate) fn mean(&self) -> Option<f64> {
        (self.count > 0).then_some(self.mean)
    }

    /// Population variance (divided by n), in the unit squared.
    pub(crate) fn population_variance(&self) -> Option<f64> {
        (self.count > 0).then(|| self.squares / f64::from(self.count))
    }

    /// Population standard deviation / mean, dimensionless; `None` unless the mean is positive.
    pub(crate) fn coefficient_of_variation(&self) -> Option<f64> {
        let variance = self.population_variance()?;
        (self.mean > 0.0).then(|| variance.sqrt() / self.mean)
    }
}

/// A slope by Theil and Sen, and what it rests on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct TheilSen {
    /// Median slope over all pairs, in units of y per unit of x.
    pub slope: f64,
    /// Lower end of the 95 % confidence interval.
    pub low_95: f64,
    /// Upper end of the 95 % confidence interval.
    pub high_95: f64,
    /// Number of pairs.
    pub pairs: usize,
}

/// Median slope of y over x over all pairs of points of one group whose x differ by at least `minimum_step`
/// (Theil 1950, Sen 1968). `None` when no pair qualifies.
///
/// The interval is Sen's, from the ranks of the slopes: it assumes independent errors. Sen's variance of
/// Kendall's S, n(n−1)(2n+5)/18, holds for all pairs of one group only. For any set of P pairs of independent
/// points, sgn-terms that share a point have covariance ±1/3, which gives `Var S = (P + Σ_i D_i²)/3`, D_i being
/// the number of pairs in which point i has the smaller x less those in which it has the larger; for all
/// pairs of n points that is Sen's value.
///
/// Time and memory grow with the square of the group size.
#[must_use]
pub(crate) fn theil_sen<'a>(
    groups: impl IntoIterator<Item = &'a [(f64, f64)]>,
    minimum_step: f64,
) -> Option<TheilSen> {
    let mut slopes = Vec::new();
    let mut balance_squares = 0.0;
    for group in groups {
        balance_squares += collect_slopes(group, minimum_step, &mut slopes);
    }
    if slopes.is_empty() {
        return None;
    }
    slopes.sort_unstable_by(f64::total_cmp);
    let pairs = slopes.len() as f64;
    let half_width = Z_95 * ((pairs + balance_squares) / 3.0).sqrt();
    // A float cast to usize saturates at 0, so only the upper end needs a bound.
    let low = (((pairs - half_width) / 2.0).round() - 1.0) as usize;
    let high = (((pairs + half_width) / 2.0).round() as usize).min(slopes.len() - 1);
    let (low_95, high_95) = (slopes[low], slopes[high]);
    Some(TheilSen { slope: median(&mut slopes)?, low_95, high_95, pairs: slopes.len() })
}

/// Adds the slopes of all pairs of `group`; returns `Σ D_i²`.
fn collect_slopes(group: &[(f64, f64)], minimum_step: f64, slopes: &mut Vec<f64>) -> f64 {
    let mut balance = vec![0i64; group.len()];
    for (i, &(x, y)) in group.iter().enumerate() {
        for (j, &(other_x, other_y)) in group.iter().enumerate().skip(i + 1) {
            let step = other_x - x;
            if step != 0.0 && step.abs() >= minimum_step {
                slopes.push((other_y - y) / step);
                let sign = if step > 0.0 { 1 } else { -1 };
                balance[i] += sign;
                balance[j] -= sign;
            }
        }
    }
    balance.iter().map(|&count| (count * count) as f64).sum()
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn quantiles_interpolate_between_order_statistics() {
        // By hand: position 0.95·3 = 2.85 between the order statistics 3 and 10.
        let mut values = [10.0, 1.0, 3.0, 2.0];
        assert_eq!(quantile(&mut values, 0.0), Some(1.0));
        assert_eq!(quantile(&mut values, 0.5), Some(2.5));
        assert!((quantile(&mut values, 0.95).unwrap() - (3.0 + 0.85 * 7.0)).abs() < 1e-12);
        assert_eq!(quantile(&mut values, 1.0), Some(10.0));
        assert_eq!(upper_median(&mut values), Some(3.0));
    }

    #[test]
    fn what_cannot_be_computed_is_none() {
        assert_eq!((median(&mut []), upper_median(&mut [])), (None, None));
        assert_eq!(quantile(&mut [1.0], 1.5), None);
        assert_eq!(quantile(&mut [1.0], f64::NAN), None);
        assert_eq!(median_absolute_deviation(&mut []), None);
        assert_eq!(Moments::default().coefficient_of_variation(), None);
        assert_eq!(theil_sen([[(1.0, 2.0), (1.0, 3.0)].as_slice()], 0.0), None);
    }

    #[test]
    fn one_outlier_does_not_move_the_mad() {
        // Median 3, deviations 2 1 0 1 997.
        assert_eq!(median_absolute_deviation(&mut [1.0, 2.0, 3.0, 4.0, 1000.0]), Some(1.0));
    }

    #[test]
    fn theil_sen_agrees_with_scipy() {
        // scipy.stats.theilslopes([1, 3, 2, 6, 5, 9, 7], [0, 1, 2, 4, 5, 7, 8])
        let points = [(0.0, 1.0), (1.0, 3.0), (2.0, 2.0), (4.0, 6.0), (5.0, 5.0), (7.0, 9.0), (8.0, 7.0)];
        let fit = theil_sen([points.as_slice()], 0.0).unwrap();
        assert_eq!(fit.pairs, 21);
        for (found, expected) in [(fit.slope, SCIPY[0]), (fit.low_95, SCIPY[1]), (fit.high_95, SCIPY[2])] {
            assert!((found - expected).abs() < 1e-12, "{found} {expected}");
        }
    }

    const SCIPY: [f64; 3] = [0.833_333_333_333_333_4, 0.25, 1.4];

    #[test]
    fn pairs_stay_within_their_group_and_above_the_step() {
        let first = [(0.0, 0.0), (1.0, 2.0), (1.05, 90.0)];
        let second = [(0.0, 100.0), (1.0, 102.0)];
        let fit = theil_sen([first.as_slice(), second.as_slice()], 0.1).unwrap();
        // 0→1 twice with slope 2, 0→1.05 with slope 85.7; the pair 1→1.05 is too short.
        assert_eq!((fit.pairs, fit.slope), (3, 2.0));
    }

    /// The variance of S by its definition, over all permutations of the errors of four points.
    #[test]
    fn the_variance_of_s_is_that_of_all_permutations() {
        let pairs = [(0usize, 1usize), (0, 3), (1, 3), (2, 3)];
        let mut sums = Vec::new();
        for code in 0..256usize {
            let ranks = [code & 3, code >> 2 & 3, code >> 4 & 3, code >> 6];
            if (0..4).all(|rank| ranks.contains(&rank)) {
                let s: f64 = pairs.iter().map(|&(i, j)| if ranks[j] > ranks[i] { 1.0 } else { -1.0 }).sum();
                sums.push(s);
            }
        }
        let variance = sums.iter().map(|s| s * s).sum::<f64>() / sums.len() as f64;
        let balance = [2.0f64, 0.0, 1.0, -3.0];
        let expected = (4.0 + balance.iter().map(|d| d * d).sum::<f64>()) / 3.0;
        assert_eq!(sums.len(), 24);
        assert!((variance - expected).abs() < 1e-12, "{variance} {expected}");
    }

    proptest! {
        #[test]
        fn quantile_equals_that_of_the_sorted_list(
            mut values in prop::collection::vec(-1e6..1e6f64, 1..40), fraction in 0.0..=1.0f64,
        ) {
            let mut sorted = values.clone();
            sorted.sort_by(f64::total_cmp);
            let position = fraction * (sorted.len() - 1) as f64;
            let (low, high) = (sorted[position.floor() as usize], sorted[position.ceil() as usize]);
            let expected = low + (position - position.floor()) * (high - low);
            let found = quantile(&mut values, fraction).unwrap();
            // Two roundings at the size of the values.
            prop_assert!((found - expected).abs() <= 1e6 * 4.0 * f64::EPSILON);
        }

        #[test]
        fn moments_equal_the_two_pass_formula(values in prop::collection::vec(1.0..1e4f64, 1..50)) {
            let mut moments = Moments::default();
            values.iter().for_each(|&value| moments.push(value));
            let n = values.len() as f64;
            let mean = values.iter().sum::<f64>() / n;
            let variance = values.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>() / n;
            // n roundings at the size of the values and of their squares.
            prop_assert!((moments.mean().unwrap() - mean).abs() < 50.0 * 1e4 * f64::EPSILON);
            prop_assert!((moments.population_variance().unwrap() - variance).abs() < 100.0 * 1e8 * f64::EPSILON);
        }
    }
}
