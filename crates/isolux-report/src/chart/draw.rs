//! One chart as SVG, laid out for one width.

use std::cell::RefCell;
use std::rc::Rc;

use plotters::chart::{ChartBuilder, ChartContext, LabelAreaPosition};
use plotters::coord::Shift;
use plotters::coord::cartesian::Cartesian2d;
use plotters::drawing::{DrawingArea, IntoDrawingArea};
use plotters::element::{Circle, EmptyElement, PathElement, Polygon, Text};
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{Color, IntoFont, ShapeStyle, TextStyle};

use super::backend::{Canvas, Role, StyledSvg, UNITS};
use super::curves::{Curve, Place};
use super::layout::Layout;
use super::marker;
use super::scale::PlacedAxis;
use crate::markup::{Escaped, put};
use crate::page::{Chart, MarkAxis, Stroke};

type Area = DrawingArea<StyledSvg, Shift>;
type Frame<'a> = ChartContext<'a, StyledSvg, Cartesian2d<PlacedAxis, PlacedAxis>>;
type Shared = Rc<RefCell<Canvas>>;
/// What the plotting library says when it cannot draw.
type Drawn<T = ()> = Result<T, String>;

/// The elements inside the `<svg>` of a chart.
pub(super) fn draw(chart: &Chart, layout: &Layout) -> Drawn<String> {
    let shared = Shared::default();
    let size = (units(layout.width) as u32, units(layout.height) as u32);
    let area = StyledSvg::new(size, Rc::clone(&shared)).into_drawing_area();
    let mut frame = draw_axes(&area, layout)?;
    draw_labels(&area, layout)?;
    draw_mark_lines(&mut frame, chart, layout)?;
    for (index, curve) in layout.curves.iter().enumerate() {
        draw_curve(&mut frame, &shared, chart, index, curve)?;
    }
    draw_mark_labels(&area, layout)?;
    if layout.curves.iter().all(|curve| curve.lines.is_empty() && curve.markers.is_empty()) {
        let middle = (layout.left + layout.plot_width / 2.0, layout.top + layout.plot_height / 2.0);
        draw_text(&area, "no values to draw", Role::Label, middle, HPos::Center)?;
    }
    let svg = shared.borrow_mut().take();
    Ok(svg)
}

/// Pixels as drawing units.
fn units(pixels: f64) -> i32 {
    (pixels * f64::from(UNITS)).round() as i32
}

fn told(error: impl std::fmt::Display) -> String {
    error.to_string()
}

fn shape(role: Role) -> ShapeStyle {
    ShapeStyle::from(&role.colour()).filled()
}

/// The size matters only for the library's layout: what is seen is the style sheet's.
fn letters(role: Role) -> TextStyle<'static> {
    let mut style = TextStyle::from(("sans-serif", 13 * UNITS).into_font());
    style.color = role.colour().to_backend_color();
    style
}

fn draw_axes<'a>(area: &'a Area, layout: &Layout) -> Drawn<Frame<'a>> {
    let mut frame = ChartBuilder::on(area)
        .margin_top(units(layout.top))
        .margin_right(units(layout.width - layout.left - layout.plot_width))
        .set_label_area_size(LabelAreaPosition::Left, units(layout.left))
        .set_label_area_size(
            LabelAreaPosition::Bottom,
            units(layout.height - layout.top - layout.plot_height),
        )
        .build_cartesian_2d(
            PlacedAxis::new(&layout.x, &layout.x_ticks),
            PlacedAxis::new(&layout.y, &layout.y_ticks),
        )
        .map_err(told)?;
    frame
        .configure_mesh()
        .light_line_style(shape(Role::Minor))
        .bold_line_style(shape(Role::Grid))
        .axis_style(shape(Role::Axis))
        .label_style(letters(Role::Tick))
        .set_all_tick_mark_size(4 * UNITS)
        .draw()
        .map_err(told)?;
    Ok(frame)
}

fn draw_text(area: &Area, text: &str, role: Role, (x, y): (f64, f64), side: HPos) -> Drawn {
    let style = letters(role).pos(Pos::new(side, VPos::Center));
    area.draw(&Text::new(text, (units(x), units(y)), style)).map_err(told)
}

fn draw_labels(area: &Area, layout: &Layout) -> Drawn {
    for (line, y) in &layout.y_label {
        draw_text(area, line, Role::Label, (0.0, *y), HPos::Left)?;
    }
    for (line, y) in &layout.x_label {
        draw_text(area, line, Role::Label, (layout.left + layout.plot_width, *y), HPos::Right)?;
    }
    Ok(())
}

fn draw_mark_lines(frame: &mut Frame<'_>, chart: &Chart, layout: &Layout) -> Drawn {
    for mark in &chart.marks {
        let line: Option<[Place; 2]> = match mark.axis {
            MarkAxis::X => layout.x.place(mark.at).map(|x| [(x, 0.0), (x, 1.0)]),
            MarkAxis::Y => layout.y.place(mark.at).map(|y| [(0.0, y), (1.0, y)]),
        };
        if let Some(line) = line.filter(|line| line.iter().all(super::curves::inside)) {
            frame.draw_series([PathElement::new(line.to_vec(), shape(Role::Mark))]).map_err(told)?;
        }
    }
    Ok(())
}

fn draw_mark_labels(area: &Area, layout: &Layout) -> Drawn {
    for label in &layout.mark_labels {
        draw_text(area, &label.text, Role::MarkLabel, label.at, label.side)?;
    }
    Ok(())
}

fn draw_curve(frame: &mut Frame<'_>, shared: &Shared, chart: &Chart, index: usize, curve: &Curve) -> Drawn {
    let series = &chart.series[index];
    let mut head = String::new();
    let dashed = if series.stroke == Stroke::Dashed { " dashed" } else { "" };
    put!(head, "<g class=\"{}{dashed}\"><title>{}</title>\n", super::class(index), Escaped(&series.name));
    shared.borrow_mut().push(&head);
    let lines = curve.lines.iter().map(|line| PathElement::new(line.clone(), shape(Role::Data)));
    frame.draw_series(lines).map_err(told)?;
    let radius = match curve.markers.len() {
        0..=100 => 3.6,
        101..=1000 => 2.6,
        _ => 1.6,
    };
    draw_markers(frame, index, &curve.markers, radius)?;
    if !curve.keys.is_empty() {
        shared.borrow_mut().push("<g class=\"keys\">\n");
        draw_markers(frame, index, &curve.keys, 3.6)?;
        shared.borrow_mut().push("</g>\n");
    }
    shared.borrow_mut().push("</g>\n");
    Ok(())
}

fn draw_markers(frame: &mut Frame<'_>, index: usize, places: &[Place], radius: f64) -> Drawn {
    let corners = marker::corners(index, radius);
    if corners.is_empty() {
        let discs = places.iter().map(|&place| Circle::new(place, units(radius), shape(Role::Data)));
        return frame.draw_series(discs).map(drop).map_err(told);
    }
    let corners: Vec<(i32, i32)> = corners.iter().map(|&(x, y)| (units(x), units(y))).collect();
    let shapes = places
        .iter()
        .map(|&place| EmptyElement::at(place) + Polygon::new(corners.clone(), shape(Role::Data)));
    frame.draw_series(shapes).map(drop).map_err(told)
}
