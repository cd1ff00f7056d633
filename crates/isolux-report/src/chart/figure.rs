//! The figure of a chart: a legend, the drawings for screens and for phones, and a caption.

use super::curves::turn;
use super::draw::put_drawing;
use super::layout::{Format, Layout};
use super::marker;
use crate::companions::{Companions, put_csv_link};
use crate::markup::{Escaped, put};
use crate::page::{Axis, Chart, Scale, Stroke};

/// Appends the figure.
pub(crate) fn put_chart(out: &mut String, chart: &Chart, companions: Companions) {
    put!(out, "<figure class=\"chart\" id=\"{}\">\n", chart.id);
    put_legend(out, chart);
    for format in [Format::Wide, Format::Narrow] {
        let layout = Layout::new(chart, format);
        put!(
            out,
            "<svg class=\"plot {}\" role=\"img\" aria-label=\"{}\" viewBox=\"0 0 {} {}\" \
             xmlns=\"http://www.w3.org/2000/svg\">\n",
            format.class(),
            Escaped(&chart.alt),
            layout.width,
            layout.height
        );
        put_drawing(out, chart, &layout);
        out.push_str("</svg>\n");
    }
    put!(out, "<figcaption>{}", Escaped(&chart.caption));
    if let Some(note) = left_out(chart) {
        put!(out, " <span class=\"note\">{note}</span>");
    }
    put_csv_link(out, &chart.id, companions);
    out.push_str("</figcaption>\n</figure>\n");
}

/// What the reader of a logarithmic chart must know: how many points it cannot show.
fn left_out(chart: &Chart) -> Option<String> {
    let lost = |axis: &Axis, value: f64| axis.scale == Scale::Log && value <= 0.0;
    let points = chart.series.iter().flat_map(|series| &series.points);
    match points.filter(|&&(x, y)| lost(&chart.x, x) || lost(&chart.y, y)).count() {
        0 => None,
        1 => Some("One point that is not positive has no place on the logarithmic axis.".to_owned()),
        count => Some(format!("{count} points that are not positive have no place on the logarithmic axis.")),
    }
}

fn put_legend(out: &mut String, chart: &Chart) {
    if chart.series.iter().all(|series| series.name.is_empty()) {
        return;
    }
    out.push_str("<ul class=\"legend\">\n");
    for (index, series) in chart.series.iter().enumerate() {
        let dashed = if series.stroke == Stroke::Dashed { " dashed" } else { "" };
        put!(
            out,
            "<li><svg class=\"swatch {}{dashed}\" viewBox=\"-16 -7 32 14\" aria-hidden=\"true\" \
             xmlns=\"http://www.w3.org/2000/svg\">",
            marker::class(index)
        );
        if series.stroke != Stroke::Points {
            out.push_str("<path class=\"line\" d=\"M-15 0L15 0\"/>");
        }
        let keyed = turn(chart, index).1 > 1;
        if matches!(series.stroke, Stroke::Points | Stroke::SolidPoints) || keyed {
            put_swatch_marker(out, index);
        }
        put!(out, "</svg>{}</li>\n", Escaped(&series.name));
    }
    out.push_str("</ul>\n");
}

fn put_swatch_marker(out: &mut String, index: usize) {
    let corners = marker::corners(index, marker::RADIUS);
    if corners.is_empty() {
        put!(out, "<circle class=\"dots\" r=\"{}\"/>", marker::RADIUS);
        return;
    }
    out.push_str("<polygon class=\"dots\" points=\"");
    for (x, y) in corners {
        put!(out, "{x:.1},{y:.1} ");
    }
    out.push_str("\"/>");
}
