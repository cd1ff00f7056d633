//! What the neighbours of a point on a smooth curve say about it.

/// By how much `curve[at]` (x increasing) departs from the lines through its neighbours: through the two beside it,
/// the two before and the two after. It is the smallest of the departures, and 0 where they point to different sides:
/// a bend of the curve is no departure. At an end, there is one line only. `None` with fewer than three points.
pub(super) fn departure(curve: &[(f64, f64)], at: usize) -> Option<f64> {
    let (x, y) = *curve.get(at)?;
    let line = |a: Option<usize>, b: Option<usize>| {
        let ((x0, y0), (x1, y1)) = (*curve.get(a?)?, *curve.get(b?)?);
        (x1 != x0).then(|| y - (y0 + (x - x0) * (y1 - y0) / (x1 - x0)))
    };
    let (before, after) = (|steps| at.checked_sub(steps), |steps| Some(at + steps));
    let lines = [line(before(1), after(1)), line(before(2), before(1)), line(after(1), after(2))];
    let departures = || lines.into_iter().flatten();
    let least = departures().min_by(|a, b| a.abs().total_cmp(&b.abs()))?;
    let one_side = departures().all(|departure| departure * least > 0.0);
    Some(if one_side { least } else { 0.0 })
}

/// The value at `x` of the line through the nearest points of `curve` (x increasing) on both sides, or the two
/// nearest on one side; `None` with fewer than two points.
pub(super) fn expected(curve: &[(f64, f64)], x: f64) -> Option<f64> {
    let above = curve.partition_point(|point| point.0 < x).clamp(1, curve.len().max(2) - 1);
    let ((x0, y0), (x1, y1)) = (*curve.get(above - 1)?, *curve.get(above)?);
    (x1 != x0).then(|| y0 + (x - x0) * (y1 - y0) / (x1 - x0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bend_is_no_departure_and_a_stray_point_is_one() {
        let mut curve: Vec<(f64, f64)> = (0..9).map(|i| (f64::from(i), f64::from(i.min(4)))).collect();
        assert!((0..9).all(|at| departure(&curve, at).unwrap().abs() < 1e-12));
        curve[5].1 = 1.0;
        assert_eq!(departure(&curve, 5), Some(-3.0));
        assert_eq!(departure(&curve[..2], 0), None);
        assert_eq!((expected(&curve, 2.5), expected(&curve, -1.0)), (Some(2.5), Some(-1.0)));
        assert_eq!(expected(&curve[..1], 2.0), None);
    }
}
