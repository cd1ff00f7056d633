//! One equation in one unknown: where a growing function reaches a value, and how far it grows.

/// Newton's steps that a root is given; a bisection takes over where they leave the bracket, so that 100 always do.
const ROUNDS: usize = 100;

/// The x in 0..=`end` at which a function that grows there, from 0 at 0, reaches `value`; `None` beyond its end.
/// `of` gives the function and its derivative.
pub(super) fn root(of: impl Fn(f64) -> (f64, f64), end: f64, value: f64) -> Option<f64> {
    if !(value >= 0.0 && value <= of(end).0) {
        return None;
    }
    let (mut low, mut high) = (0.0, end);
    let mut x = value.min(0.5 * end);
    for _ in 0..ROUNDS {
        let (here, slope) = of(x);
        if here < value {
            low = x
        } else {
            high = x
        }
        let newton = x - (here - value) / slope;
        let next = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
        if (next - x).abs() <= 1e-15 * (1.0 + x) {
            return Some(next);
        }
        x = next;
    }
    Some(x)
}

/// The greatest x in 0..=`end` up to which a function grows: where its `slope` first is no longer positive.
pub(super) fn growing_until(slope: impl Fn(f64) -> f64, end: f64) -> f64 {
    /// Finer than any fold of a polynomial of eighth degree that a calibration gives.
    const STEPS: usize = 4000;
    let at = |step: usize| end * step as f64 / STEPS as f64;
    // A slope of NaN counts as none.
    let grows = |x: f64| slope(x) > 0.0;
    let Some(first) = (0..=STEPS).find(|&step| !grows(at(step))) else { return end };
    let (mut low, mut high) = (at(first.saturating_sub(1)), at(first));
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if grows(middle) { low = middle } else { high = middle }
    }
    low
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_root_is_found_up_to_the_end_of_growth() {
        let sine = |x: f64| (x.sin(), x.cos());
        let end = growing_until(|x| sine(x).1, 3.0);
        assert!((end - std::f64::consts::FRAC_PI_2).abs() < 1e-12, "{end}");
        for value in [0.0, 1e-9, 0.5, 0.999_999] {
            let found = root(sine, end, value).unwrap();
            assert!((found - value.asin()).abs() < 1e-9, "{found} {value}");
        }
        assert_eq!(root(sine, end, 1.1), None);
        assert_eq!(root(sine, end, f64::NAN), None);
        assert!(growing_until(|_| f64::NAN, 1.0).abs() < 1e-12);
        assert_eq!(growing_until(|_| 1.0, 1.0), 1.0);
    }
}
