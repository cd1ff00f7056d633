//! The drawn parts of a series: lines cut at the frame and at gaps, markers inside the frame.

use super::scale::Extent;
use crate::page::{Chart, Series, Stroke};

/// A place in the frame: 0 to 1 along either axis.
pub(super) type Place = (f64, f64);

/// Number of markers along a line that only distinguish it from its neighbours.
const KEYS: usize = 5;

/// One series, ready to be drawn.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Curve {
    /// Lines, each of at least two places.
    pub(super) lines: Vec<Vec<Place>>,
    /// A marker for each point of the data, where the stroke has markers, and for points that no line reaches.
    pub(super) markers: Vec<Place>,
    /// A few markers along a line, so that it can be distinguished from others without its colour.
    pub(super) keys: Vec<Place>,
}

/// Which of the lines with its stroke a series is, and how many there are.
pub(super) fn turn(chart: &Chart, index: usize) -> (usize, usize) {
    let stroke = chart.series[index].stroke;
    let same = |until: usize| chart.series[..until].iter().filter(|series| series.stroke == stroke).count();
    (same(index), same(chart.series.len()))
}

/// Places of a series. `turn` of `turns` staggers the keys of lines that share a stroke; none when it is alone.
pub(super) fn curve(series: &Series, x: &Extent, y: &Extent, (turn, turns): (usize, usize)) -> Curve {
    let place = |&(px, py): &(f64, f64)| Some((x.place(px)?, y.place(py)?));
    let places: Vec<Option<Place>> = series.points.iter().map(place).collect();
    let runs = places.split(Option::is_none).map(|run| run.iter().flatten().copied().collect::<Vec<_>>());
    let mut curve = Curve::default();
    for run in runs.filter(|run| !run.is_empty()) {
        let alone = run.len() == 1;
        if matches!(series.stroke, Stroke::Points | Stroke::SolidPoints) || alone {
            curve.markers.extend(run.iter().copied().filter(inside));
        }
        if series.stroke != Stroke::Points && !alone {
            cut(&run, &mut curve.lines);
        }
    }
    if turns > 1 && matches!(series.stroke, Stroke::Solid | Stroke::Dashed) {
        curve.keys = keys(&curve.lines, turn, turns);
    }
    curve
}

/// Whether a place is within the frame, its edge included.
pub(super) fn inside(&(x, y): &Place) -> bool {
    let within = |place: f64| (-1e-9..=1.0 + 1e-9).contains(&place);
    within(x) && within(y)
}

/// Appends the parts of a run that are inside the frame.
fn cut(run: &[Place], lines: &mut Vec<Vec<Place>>) {
    let mut open: Vec<Place> = Vec::new();
    for pair in run.windows(2) {
        match cut_segment(pair[0], pair[1]) {
            Some((from, to)) => {
                if open.last() != Some(&from) {
                    close(&mut open, lines);
                    open.push(from);
                }
                open.push(to);
            }
            None => close(&mut open, lines),
        }
    }
    close(&mut open, lines);
}

fn close(open: &mut Vec<Place>, lines: &mut Vec<Vec<Place>>) {
    let line = std::mem::take(open);
    if line.len() > 1 {
        lines.push(line);
    }
}

/// Liang and Barsky, "A new concept and method for line clipping" (ACM TOG 1984), on the unit square.
pub(super) fn cut_segment(from: Place, to: Place) -> Option<(Place, Place)> {
    let (dx, dy) = (to.0 - from.0, to.1 - from.1);
    let (mut enter, mut leave) = (0.0f64, 1.0f64);
    for (direction, room) in [(-dx, from.0), (dx, 1.0 - from.0), (-dy, from.1), (dy, 1.0 - from.1)] {
        if direction == 0.0 {
            if room < 0.0 {
                return None;
            }
        } else if direction < 0.0 {
            enter = enter.max(room / direction);
        } else {
            leave = leave.min(room / direction);
        }
    }
    let at = |part: f64| (from.0 + part * dx, from.1 + part * dy);
    // Ends inside stay as they are, to the bit, so that the next segment continues there.
    let start = if enter > 0.0 { at(enter) } else { from };
    let end = if leave < 1.0 { at(leave) } else { to };
    (enter <= leave).then_some((start, end))
}

/// The vertices nearest to evenly spread columns, a different set of columns for each turn.
fn keys(lines: &[Vec<Place>], turn: usize, turns: usize) -> Vec<Place> {
    let mut keys: Vec<Place> = Vec::new();
    for column in 0..KEYS {
        let wanted = (column as f64 + (turn as f64 + 0.5) / turns as f64) / KEYS as f64;
        let far = |place: &Place| (place.0 - wanted).abs();
        let nearest = lines.iter().flatten().min_by(|a, b| far(a).total_cmp(&far(b)));
        if let Some(&place) = nearest
            && !keys.contains(&place)
            && inside(&place)
        {
            keys.push(place);
        }
    }
    keys
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::page::{Axis, Scale};

    fn unit() -> Extent {
        let axis = Axis { label: String::new(), scale: Scale::Linear, range: Some((0.0, 1.0)) };
        Extent::of(&axis, std::iter::empty())
    }

    fn drawn(points: &[(f64, f64)], stroke: Stroke) -> Curve {
        let series = Series { name: String::new(), points: points.to_vec(), stroke };
        curve(&series, &unit(), &unit(), (0, 1))
    }

    #[test]
    fn gaps_interrupt_and_lone_points_get_a_marker() {
        let nan = f64::NAN;
        let points =
            [(0.1, 0.1), (0.2, 0.2), (nan, 0.0), (0.5, 0.5), (0.6, nan), (0.7, 0.7), (0.8, 0.8), (0.9, 0.9)];
        let curve = drawn(&points, Stroke::Solid);
        assert_eq!(curve.lines.iter().map(Vec::len).collect::<Vec<_>>(), [2, 3]);
        assert_eq!(curve.markers, [(0.5, 0.5)]);
    }

    #[test]
    fn lines_end_at_the_frame_and_keep_their_slope() {
        let curve = drawn(&[(0.0, 0.5), (1.0, 2.5), (1.0, 0.0)], Stroke::Solid);
        assert_eq!(curve.lines, [vec![(0.0, 0.5), (0.25, 1.0)], vec![(1.0, 1.0), (1.0, 0.0)]]);
        assert_eq!(drawn(&[(-1.0, 2.0), (2.0, 2.0)], Stroke::Solid).lines, Vec::<Vec<Place>>::new());
        assert_eq!(drawn(&[(-1.0, 0.5), (2.0, 0.5)], Stroke::Solid).lines, [vec![(0.0, 0.5), (1.0, 0.5)]]);
    }

    #[test]
    fn each_point_inside_has_a_marker() {
        let curve = drawn(&[(0.0, 0.0), (0.5, 0.5), (1.0, 1.0), (1.5, 0.5)], Stroke::Points);
        assert_eq!((curve.markers.len(), curve.lines.len()), (3, 0));
    }
}
