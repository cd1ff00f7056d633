//! The elements of a drawing as SVG. They carry classes only: their colours, widths and fonts are the style sheet's,
//! which suits light pages and dark ones alike.

use super::text::Anchor;
use crate::markup::{Escaped, put};

/// Drawing units in a pixel of the page. Whole tenths keep the numbers of a page short.
const UNITS: f64 = 10.0;

/// A point of the drawing in units, from its left top corner.
pub(super) type Point = (i32, i32);

/// Pixels as drawing units.
pub(super) fn units(pixels: f64) -> i32 {
    (pixels * UNITS).round() as i32
}

/// Drawing units as pixels, with a decimal where there is one.
fn pixels(units: i32) -> f64 {
    f64::from(units) / UNITS
}

/// Appends straight lines from point to point.
pub(super) fn put_line(out: &mut String, class: &str, points: impl IntoIterator<Item = Point>) {
    put!(out, "<path class=\"{class}\" d=\"");
    put_corners(out, points);
    out.push_str("\"/>\n");
}

/// Appends a line of text, `anchor` of it at the point.
pub(super) fn put_text(out: &mut String, class: &str, text: &str, (x, y): Point, anchor: Anchor) {
    let side = match anchor {
        Anchor::Left => "start",
        Anchor::Middle | Anchor::Top => "middle",
        Anchor::Right => "end",
    };
    // From the height of the point down to the base line of the letters.
    let shift = if anchor == Anchor::Top { "0.78em" } else { "0.35em" };
    put!(
        out,
        "<text class=\"{class}\" x=\"{}\" y=\"{}\" dy=\"{shift}\" text-anchor=\"{side}\">{}</text>\n",
        pixels(x),
        pixels(y),
        Escaped(text)
    );
}

/// Appends a marker at each point: discs of `radius` pixels, or polygons where there are corners, pixels from the
/// point. They share one path, because thousands of elements would make pages slow.
pub(super) fn put_markers(out: &mut String, points: &[Point], corners: &[(f64, f64)], radius: f64) {
    if points.is_empty() {
        return;
    }
    out.push_str("<path class=\"dots\" d=\"");
    for &(x, y) in points {
        if corners.is_empty() {
            put_disc(out, (x, y), units(radius));
        } else {
            put_corners(out, corners.iter().map(|&(dx, dy)| (x + units(dx), y + units(dy))));
            out.push('z');
        }
    }
    out.push_str("\"/>\n");
}

fn put_corners(out: &mut String, points: impl IntoIterator<Item = Point>) {
    for (index, (x, y)) in points.into_iter().enumerate() {
        put!(out, "{}{} {}", if index == 0 { 'M' } else { 'L' }, pixels(x), pixels(y));
    }
}

fn put_disc(out: &mut String, (x, y): Point, radius: i32) {
    let (left, y, radius) = (pixels(x - radius), pixels(y), pixels(radius));
    let across = 2.0 * radius;
    put!(out, "M{left} {y}a{radius} {radius} 0 1 0 {across} 0a{radius} {radius} 0 1 0 -{across} 0z");
}
