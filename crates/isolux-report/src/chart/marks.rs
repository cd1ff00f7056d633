//! Where the labels of marks go, so that they cover neither data nor each other.

use super::curves::{Curve, Place, cut_segment, inside};
use super::scale::Extent;
use super::text::{self, Anchor, LETTERS, LINE, wrap};
use crate::numbers::scientific;
use crate::page::{Chart, Mark, MarkAxis};

/// Room between a label and the end of the frame or another label, pixels.
const ROOM: f64 = 6.0;
/// Places along a horizontal line that are tried for its label.
const TRIES: usize = 9;

/// One line of text beside a mark.
#[derive(Clone)]
pub(super) struct MarkLabel {
    pub(super) text: String,
    /// Where `anchor` of the text is, pixels.
    pub(super) at: (f64, f64),
    pub(super) anchor: Anchor,
}

/// The frame that holds the curves, its top at 0, pixels.
#[derive(Clone, Copy, Debug)]
struct Frame {
    left: f64,
    width: f64,
    height: f64,
}

/// Left, top, right and bottom, pixels.
type Rectangle = (f64, f64, f64, f64);

fn on(chart: &Chart, axis: MarkAxis) -> impl Iterator<Item = &Mark> {
    chart.marks.iter().filter(move |mark| mark.axis == axis)
}

/// Labels of vertical lines in rows that start at `top`, for a frame from `left`, `plot_width` wide, in a drawing of
/// `whole` pixels; and the height of the rows.
pub(super) fn above(
    chart: &Chart,
    x: &Extent,
    (left, plot_width): (f64, f64),
    whole: f64,
    top: f64,
) -> (Vec<MarkLabel>, f64) {
    let mut labels = Vec::new();
    let mut rows: Vec<Vec<(f64, f64)>> = Vec::new();
    for mark in on(chart, MarkAxis::X) {
        let Some(place) = x.place(mark.at).filter(|&x| inside(&(x, 0.0))) else { continue };
        for text in wrap(&mark.label, LETTERS, whole - 8.0) {
            let half = text::width(&text, LETTERS) / 2.0;
            let middle = whole / 2.0;
            let centre = (left + place * plot_width).clamp(half.min(middle), (whole - half).max(middle));
            let span = (centre - half - ROOM, centre + half + ROOM);
            let free = |row: &Vec<(f64, f64)>| row.iter().all(|taken| span.1 < taken.0 || span.0 > taken.1);
            let row = rows.iter().position(free).unwrap_or(rows.len());
            rows.resize_with(rows.len().max(row + 1), Vec::new);
            rows[row].push(span);
            labels.push(MarkLabel {
                text,
                at: (centre, top + LINE * (row as f64 + 0.5)),
                anchor: Anchor::Middle,
            });
        }
    }
    let gap = if rows.is_empty() { 0.0 } else { 2.0 };
    (labels, LINE * rows.len() as f64 + gap)
}

/// Labels of horizontal lines: just above or below their line where nothing else is, in a frame whose top is at 0;
/// and those that have no such place, with the value of their line.
pub(super) fn beside(
    chart: &Chart,
    (x, y): (&Extent, &Extent),
    (left, width): (f64, f64),
    height: f64,
    curves: &[Curve],
) -> (Vec<MarkLabel>, Vec<String>) {
    let frame = Frame { left, width, height };
    let (mut labels, mut homeless) = (Vec::new(), Vec::new());
    let mut taken: Vec<Rectangle> = Vec::new();
    let verticals: Vec<f64> = on(chart, MarkAxis::X).filter_map(|mark| x.place(mark.at)).collect();
    for mark in on(chart, MarkAxis::Y).filter(|mark| !mark.label.is_empty()) {
        let Some(place) = y.place(mark.at).filter(|&y| inside(&(0.0, y))) else { continue };
        let line = (1.0 - place) * frame.height;
        let lines = wrap(&mark.label, LETTERS, frame.width - 2.0 * ROOM);
        let widest = lines.iter().map(|text| text::width(text, LETTERS)).fold(0.0, f64::max);
        let free = |rectangle: &Rectangle| {
            !taken.iter().any(|other| overlap(rectangle, other))
                && !covers(rectangle, frame, curves, &verticals)
        };
        let size = (widest, LINE * lines.len() as f64);
        let Some(best) = candidates(line, size, frame).into_iter().find(free) else {
            homeless.push(format!("⋯ {} (at {})", mark.label, short(mark.at)));
            continue;
        };
        taken.push(best);
        for (row, text) in lines.into_iter().enumerate() {
            let at = (best.2, best.1 + LINE * (row as f64 + 0.5));
            labels.push(MarkLabel { text, at, anchor: Anchor::Right });
        }
    }
    (labels, homeless)
}

/// Three digits.
fn short(value: f64) -> String {
    if value == 0.0 || !(1e-3..1e5).contains(&value.abs()) {
        return if value == 0.0 { "0".to_owned() } else { scientific(value, 2) };
    }
    let decimals = (2.0 - value.abs().log10().floor()).max(0.0) as usize;
    let text = format!("{value:.decimals$}");
    if decimals > 0 { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

/// Rectangles above and below the line, from the right end of the frame to the left one, inside the frame where
/// one of the two is.
fn candidates(line: f64, (width, height): (f64, f64), frame: Frame) -> Vec<Rectangle> {
    let free = (frame.width - width - 2.0 * ROOM).max(0.0);
    let (above, below) = (line - height - 1.0, line + 2.0);
    let starts = match (above >= 0.0, below + height <= frame.height) {
        (true, false) => vec![above],
        (false, true) => vec![below],
        _ => vec![above, below],
    };
    let at = |step: usize, top: f64| {
        let right = frame.left + frame.width - ROOM - free * step as f64 / (TRIES - 1) as f64;
        (right - width, top, right, top + height)
    };
    (0..TRIES).flat_map(|step| starts.iter().map(move |&top| at(step, top))).collect()
}

fn overlap(a: &Rectangle, b: &Rectangle) -> bool {
    a.0 < b.2 + ROOM && b.0 < a.2 + ROOM && a.1 < b.3 && b.1 < a.3
}

/// Whether a label there would touch a curve, a marker or a vertical line.
fn covers(rectangle: &Rectangle, frame: Frame, curves: &[Curve], verticals: &[f64]) -> bool {
    let &(left, top, right, bottom) = rectangle;
    // The rectangle becomes the unit square.
    let local = |&(x, y): &Place| {
        let (x, y) = (frame.left + x * frame.width, (1.0 - y) * frame.height);
        ((x - left + 2.0) / (right - left + 4.0), (y - top + 1.0) / (bottom - top + 2.0))
    };
    let touches = |pair: &[Place]| cut_segment(local(&pair[0]), local(&pair[1])).is_some();
    let touched = |curve: &Curve| {
        curve.lines.iter().any(|line| line.windows(2).any(touches))
            || curve.markers.iter().any(|place| inside(&local(place)))
    };
    curves.iter().any(touched) || verticals.iter().any(|&x| touches(&[(x, 0.0), (x, 1.0)]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::page::{Axis, Scale};

    fn chart(marks: &[(MarkAxis, f64)]) -> Chart {
        let axis = || Axis { label: String::new(), scale: Scale::Linear, range: Some((0.0, 1.0)) };
        let mark = |&(axis, at): &(MarkAxis, f64)| Mark { axis, at, label: "a threshold".into() };
        Chart {
            id: "c".into(),
            caption: String::new(),
            alt: String::new(),
            x: axis(),
            y: axis(),
            series: vec![],
            marks: marks.iter().map(mark).collect(),
        }
    }

    #[test]
    fn a_label_moves_away_from_curves_and_stays_in_the_frame() {
        let chart = chart(&[(MarkAxis::Y, 0.5), (MarkAxis::Y, 1.0), (MarkAxis::Y, 0.0)]);
        let extent = Extent::of(&chart.x, std::iter::empty());
        // A curve that fills the right half just above and below the line.
        let curve = Curve {
            lines: vec![vec![(0.6, 0.55), (1.0, 0.55)], vec![(0.6, 0.45), (1.0, 0.45)]],
            ..Curve::default()
        };
        let (labels, homeless) = beside(&chart, (&extent, &extent), (0.0, 400.0), 200.0, &[curve]);
        assert_eq!((labels.len(), homeless.len()), (3, 0));
        assert!(labels[0].at.0 < 240.0, "{}", labels[0].at.0);
        for label in &labels {
            assert!(label.at.1 > 0.0 && label.at.1 < 200.0, "{}", label.at.1);
        }
    }

    #[test]
    fn a_label_without_a_free_place_names_its_value_instead() {
        let chart = chart(&[(MarkAxis::Y, 0.5)]);
        let extent = Extent::of(&chart.x, std::iter::empty());
        let zigzag = (0..200).map(|step| (f64::from(step) / 199.0, f64::from(step % 2))).collect();
        let curve = Curve { lines: vec![zigzag], ..Curve::default() };
        let (labels, homeless) = beside(&chart, (&extent, &extent), (0.0, 400.0), 200.0, &[curve]);
        assert!(labels.is_empty());
        assert_eq!(homeless, ["⋯ a threshold (at 0.5)"]);
    }

    #[test]
    fn near_labels_of_vertical_lines_get_rows_of_their_own() {
        let chart = chart(&[(MarkAxis::X, 0.5), (MarkAxis::X, 0.52), (MarkAxis::X, 0.0)]);
        let extent = Extent::of(&chart.x, std::iter::empty());
        let (labels, height) = above(&chart, &extent, (0.0, 400.0), 400.0, 0.0);
        assert!(labels[0].at.1 != labels[1].at.1 && labels[2].at.1 == labels[0].at.1);
        assert!((height - (2.0 * LINE + 2.0)).abs() < 1e-9);
    }
}
