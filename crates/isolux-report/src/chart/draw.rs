//! One chart as SVG elements, from its layout.

use super::curves::{Curve, Place, inside};
use super::layout::Layout;
use super::marker;
use super::scale::Extent;
use super::svg::{Point, put_line, put_markers, put_text, units};
use super::text::Anchor;
use super::ticks::Ticks;
use crate::markup::{Escaped, put};
use crate::page::{Chart, MarkAxis, Series, Stroke};

/// Length of the mark of a tick, pixels.
const TICK: f64 = 4.0;
/// From an axis to the labels of its ticks, pixels.
const TICK_LABEL: f64 = 8.0;

/// Appends the elements inside the `<svg>` of a chart.
pub(super) fn put_drawing(out: &mut String, chart: &Chart, layout: &Layout) {
    let frame = Frame::of(layout);
    put_axes(out, layout, &frame);
    put_axis_labels(out, layout);
    put_mark_lines(out, chart, layout, &frame);
    for (index, (series, curve)) in chart.series.iter().zip(&layout.curves).enumerate() {
        put_curve(out, index, series, curve, &frame);
    }
    for label in &layout.mark_labels {
        put_text_at(out, "mark-label", &label.text, label.at, label.anchor);
    }
    if layout.curves.iter().all(|curve| curve.lines.is_empty() && curve.markers.is_empty()) {
        let middle = (layout.left + layout.plot_width / 2.0, layout.top + layout.plot_height / 2.0);
        put_text_at(out, "label", "no values to draw", middle, Anchor::Middle);
    }
}

/// The outermost drawing units that data may take. The axes stand one unit outside, so that they cover none.
struct Frame {
    left: i32,
    top: i32,
    right: i32,
    bottom: i32,
}

impl Frame {
    fn of(layout: &Layout) -> Self {
        Self {
            left: units(layout.left),
            top: units(layout.top),
            right: units(layout.left + layout.plot_width) - 1,
            bottom: units(layout.top + layout.plot_height) - 1,
        }
    }

    fn x(&self, place: f64) -> i32 {
        between(self.left, self.right, place)
    }

    fn y(&self, place: f64) -> i32 {
        between(self.bottom, self.top, place)
    }

    fn point(&self, (x, y): Place) -> Point {
        (self.x(x), self.y(y))
    }
}

/// The unit at a place from 0, the start, to 1, the end. Rounding errors of extreme values do not lead out of the frame.
fn between(start: i32, end: i32, place: f64) -> i32 {
    (f64::from(start) + place.clamp(0.0, 1.0) * f64::from(end - start)).round() as i32
}

fn put_text_at(out: &mut String, class: &str, text: &str, (x, y): (f64, f64), anchor: Anchor) {
    put_text(out, class, text, (units(x), units(y)), anchor);
}

/// Lines at all ticks, stronger ones at those with a label, and the two axes.
fn put_axes(out: &mut String, layout: &Layout, frame: &Frame) {
    let (x_labelled, x_minor) = tick_places(&layout.x, &layout.x_ticks);
    let (y_labelled, y_minor) = tick_places(&layout.y, &layout.y_ticks);
    let x_labelled: Vec<_> = x_labelled.into_iter().map(|(place, label)| (frame.x(place), label)).collect();
    let y_labelled: Vec<_> = y_labelled.into_iter().map(|(place, label)| (frame.y(place), label)).collect();
    let xs = || x_labelled.iter().map(|&(x, _)| x);
    let ys = || y_labelled.iter().map(|&(y, _)| y);
    put_grid(
        out,
        "minor",
        frame,
        xs().chain(x_minor.into_iter().map(|place| frame.x(place))),
        ys().chain(y_minor.into_iter().map(|place| frame.y(place))),
    );
    put_grid(out, "grid", frame, xs(), ys());

    let (label, tick) = (units(TICK_LABEL), units(TICK));
    let left = frame.left - 1;
    put_line(out, "axis", [(left, frame.top), (left, frame.bottom)]);
    for &(y, text) in &y_labelled {
        put_text(out, "tick", text, (frame.left - label, y), Anchor::Right);
        put_line(out, "axis", [(left - tick, y), (left, y)]);
    }
    let bottom = frame.bottom + 1;
    put_line(out, "axis", [(frame.left, bottom), (frame.right, bottom)]);
    for &(x, text) in &x_labelled {
        put_text(out, "tick", text, (x, bottom + label), Anchor::Top);
        put_line(out, "axis", [(x, bottom), (x, bottom + tick)]);
    }
}

/// Vertical lines, then horizontal ones, from edge to edge of the frame.
fn put_grid(
    out: &mut String,
    class: &str,
    frame: &Frame,
    xs: impl Iterator<Item = i32>,
    ys: impl Iterator<Item = i32>,
) {
    for x in xs {
        put_line(out, class, [(x, frame.bottom), (x, frame.top)]);
    }
    for y in ys {
        put_line(out, class, [(frame.left, y), (frame.right, y)]);
    }
}

/// Places of the ticks that are inside the frame: those with a label, and the others.
fn tick_places<'a>(extent: &Extent, ticks: &'a Ticks) -> (Vec<(f64, &'a str)>, Vec<f64>) {
    let inside = |place: &f64| (-1e-6..=1.0 + 1e-6).contains(place);
    let place = |value: f64| extent.place(value).filter(inside);
    let labelled =
        ticks.labelled.iter().filter_map(|(value, label)| Some((place(*value)?, label.as_str()))).collect();
    (labelled, ticks.minor.iter().filter_map(|&value| place(value)).collect())
}

fn put_axis_labels(out: &mut String, layout: &Layout) {
    for (line, y) in &layout.y_label {
        put_text_at(out, "label", line, (0.0, *y), Anchor::Left);
    }
    for (line, y) in &layout.x_label {
        put_text_at(out, "label", line, (layout.left + layout.plot_width, *y), Anchor::Right);
    }
}

fn put_mark_lines(out: &mut String, chart: &Chart, layout: &Layout, frame: &Frame) {
    for mark in &chart.marks {
        let line: Option<[Place; 2]> = match mark.axis {
            MarkAxis::X => layout.x.place(mark.at).map(|x| [(x, 0.0), (x, 1.0)]),
            MarkAxis::Y => layout.y.place(mark.at).map(|y| [(0.0, y), (1.0, y)]),
        };
        if let Some(line) = line.filter(|line| line.iter().all(inside)) {
            put_line(out, "mark", line.map(|place| frame.point(place)));
        }
    }
}

fn put_curve(out: &mut String, index: usize, series: &Series, curve: &Curve, frame: &Frame) {
    let dashed = if series.stroke == Stroke::Dashed { " dashed" } else { "" };
    put!(out, "<g class=\"{}{dashed}\"><title>{}</title>\n", marker::class(index), Escaped(&series.name));
    for line in &curve.lines {
        put_line(out, "line", line.iter().map(|&place| frame.point(place)));
    }
    let put_shapes = |out: &mut String, places: &[Place], radius: f64| {
        let points: Vec<Point> = places.iter().map(|&place| frame.point(place)).collect();
        put_markers(out, &points, &marker::corners(index, radius), radius);
    };
    let radius = match curve.markers.len() {
        0..=100 => marker::RADIUS,
        101..=1000 => 2.6,
        _ => 1.6,
    };
    put_shapes(out, &curve.markers, radius);
    if !curve.keys.is_empty() {
        out.push_str("<g class=\"keys\">\n");
        put_shapes(out, &curve.keys, marker::RADIUS);
        out.push_str("</g>\n");
    }
    out.push_str("</g>\n");
}
