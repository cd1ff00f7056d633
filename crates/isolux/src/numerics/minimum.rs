//! The minimum of a function of one variable.

/// Where `cost` is least between the `bounds`: the best of 24 intervals, then the golden section in it and its
/// neighbours, down to 1e-9 of the bounds.
pub(crate) fn minimum(bounds: [f64; 2], mut cost: impl FnMut(f64) -> f64) -> f64 {
    const INTERVALS: u32 = 24;
    /// 0.618^36 of a twelfth: 2e-9.
    const HALVINGS: u32 = 36;
    let golden = 0.5 * (5f64.sqrt() - 1.0);
    let [low, high] = bounds;
    let step = (high - low) / f64::from(INTERVALS);
    let place = |i: u32| low + step * f64::from(i);
    let costs: Vec<f64> = (0..=INTERVALS).map(|i| cost(place(i))).collect();
    let best = (0..=INTERVALS).min_by(|&a, &b| costs[a as usize].total_cmp(&costs[b as usize])).unwrap_or(0);
    let (mut a, mut b) = (place(best.saturating_sub(1)), place((best + 1).min(INTERVALS)));
    let (mut left, mut right) = (b - golden * (b - a), a + golden * (b - a));
    let (mut at_left, mut at_right) = (cost(left), cost(right));
    for _ in 0..HALVINGS {
        if at_left <= at_right {
            (b, right, at_right) = (right, left, at_left);
            left = b - golden * (b - a);
            at_left = cost(left);
        } else {
            (a, left, at_left) = (left, right, at_right);
            right = a + golden * (b - a);
            at_right = cost(right);
        }
    }
    0.5 * (a + b)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_least_inside_and_at_an_end_is_found() {
        // A parabola is flat to rounding within √ε of its least.
        assert!((minimum([-3.0, 9.0], |x| (x - 2.3).powi(2)) - 2.3).abs() < 1e-6);
        assert!((minimum([1.0, 9.0], |x| x) - 1.0).abs() < 1e-6);
        assert!((minimum([1.0, 9.0], |x| -x) - 9.0).abs() < 1e-6);
    }
}
