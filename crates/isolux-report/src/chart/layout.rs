//! Where the parts of a chart are, for one width of the page.

use plotters::style::text_anchor::HPos;

use super::curves::inside;
use super::scale::Extent;
use super::text::{width, wrap};
use super::ticks::Ticks;
use crate::page::{Chart, MarkAxis};

/// Size of letters, pixels.
pub(super) const LETTERS: f64 = 13.0;
/// Height of a line of text, pixels.
const LINE: f64 = 17.0;
/// From an axis to the labels of its ticks, pixels.
const TICK: f64 = 9.0;

/// Widths that a chart is drawn for; the page shows the one that fits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Format {
    /// For screens and paper.
    Wide,
    /// For phones.
    Narrow,
}

impl Format {
    pub(super) const fn class(self) -> &'static str {
        match self {
            Self::Wide => "wide",
            Self::Narrow => "narrow",
        }
    }

    const fn width(self) -> f64 {
        match self {
            Self::Wide => 720.0,
            Self::Narrow => 340.0,
        }
    }

    const fn plot_height(self) -> f64 {
        match self {
            Self::Wide => 300.0,
            Self::Narrow => 230.0,
        }
    }

    const fn ticks(self) -> (usize, usize) {
        match self {
            Self::Wide => (9, 6),
            Self::Narrow => (6, 5),
        }
    }
}

/// A text beside a mark.
#[derive(Clone)]
pub(super) struct MarkLabel {
    pub(super) text: String,
    pub(super) at: (f64, f64),
    pub(super) side: HPos,
}

/// All sizes and places of a chart, in pixels.
pub(super) struct Layout {
    pub(super) width: f64,
    pub(super) height: f64,
    pub(super) left: f64,
    pub(super) top: f64,
    pub(super) plot_width: f64,
    pub(super) plot_height: f64,
    pub(super) x: Extent,
    pub(super) y: Extent,
    pub(super) x_ticks: Ticks,
    pub(super) y_ticks: Ticks,
    /// Lines of the label and their heights.
    pub(super) x_label: Vec<(String, f64)>,
    pub(super) y_label: Vec<(String, f64)>,
    pub(super) mark_labels: Vec<MarkLabel>,
}

impl Layout {
    pub(super) fn new(chart: &Chart, format: Format) -> Self {
        let (x_count, y_count) = format.ticks();
        let (x, y) = extents(chart, y_count);
        let y_ticks = y.ticks(y_count);
        let left = widest(&y_ticks) + TICK + 4.0;
        let (width, plot_height) = (format.width(), format.plot_height());
        let x_ticks = x_ticks(&x, x_count, width - left);
        // The last label of the axis reaches beyond its end.
        let right = x_ticks.labelled.last().map_or(0.0, |(_, label)| self::width(label, LETTERS) / 2.0) + 4.0;
        let plot_width = (width - left - right).max(80.0);
        let y_lines = wrap(&chart.y.label, LETTERS, width);
        let x_lines = wrap(&chart.x.label, LETTERS, width);
        let above = LINE * y_lines.len() as f64 + 6.0;
        let mut layout = Self {
            width,
            height: 0.0,
            left,
            top: above,
            plot_width,
            plot_height,
            x,
            y,
            x_ticks,
            y_ticks,
            x_label: Vec::new(),
            y_label: y_lines
                .into_iter()
                .enumerate()
                .map(|(row, text)| (text, LINE * (row as f64 + 0.5)))
                .collect(),
            mark_labels: Vec::new(),
        };
        layout.label_x_marks(chart);
        layout.label_y_marks(chart);
        let below = layout.top + plot_height + TICK + LINE;
        layout.height = below + LINE * x_lines.len() as f64 + 6.0;
        let x_label = x_lines.into_iter().enumerate();
        layout.x_label = x_label.map(|(row, text)| (text, below + 3.0 + LINE * (row as f64 + 0.5))).collect();
        layout
    }

    /// Labels of vertical lines, in rows above the frame, so that they cover neither data nor each other.
    fn label_x_marks(&mut self, chart: &Chart) {
        let above = self.top;
        let mut rows: Vec<Vec<(f64, f64)>> = Vec::new();
        for mark in chart.marks.iter().filter(|mark| mark.axis == MarkAxis::X) {
            let Some(place) = self.x.place(mark.at).filter(|&x| inside(&(x, 0.0))) else { continue };
            let x = self.left + place * self.plot_width;
            for text in wrap(&mark.label, LETTERS, self.width - 8.0) {
                let half = width(&text, LETTERS) / 2.0;
                let centre = x.clamp(half.min(self.width / 2.0), (self.width - half).max(self.width / 2.0));
                let span = (centre - half - 6.0, centre + half + 6.0);
                let free =
                    |row: &Vec<(f64, f64)>| row.iter().all(|taken| span.1 < taken.0 || span.0 > taken.1);
                let row = rows.iter().position(free).unwrap_or(rows.len());
                rows.resize_with(rows.len().max(row + 1), Vec::new);
                rows[row].push(span);
                let at = (centre, above + LINE * (row as f64 + 0.5));
                self.mark_labels.push(MarkLabel { text, at, side: HPos::Center });
            }
        }
        self.top = above + LINE * rows.len() as f64 + if rows.is_empty() { 0.0 } else { 2.0 };
    }

    /// Labels of horizontal lines: on the line, at the right end; at the left end where another is near.
    fn label_y_marks(&mut self, chart: &Chart) {
        let mut taken: Vec<f64> = Vec::new();
        for mark in chart.marks.iter().filter(|mark| mark.axis == MarkAxis::Y) {
            let Some(place) = self.y.place(mark.at).filter(|&y| inside(&(0.0, y))) else { continue };
            let line = self.top + (1.0 - place) * self.plot_height;
            let lines = wrap(&mark.label, LETTERS, self.plot_width - 12.0);
            let room = LINE * lines.len() as f64;
            // Above the line, unless that is outside the frame.
            let start = if line - room < self.top { line + 3.0 } else { line - room };
            let near = taken.iter().any(|other| (other - line).abs() < LINE + 2.0);
            taken.push(line);
            let (side, x) = if near {
                (HPos::Left, self.left + 6.0)
            } else {
                (HPos::Right, self.left + self.plot_width - 6.0)
            };
            for (row, text) in lines.into_iter().enumerate() {
                let at = (x, start + LINE * (row as f64 + 0.5) - 1.0);
                self.mark_labels.push(MarkLabel { text, at, side });
            }
        }
    }
}

/// Axes that hold all points and marks. A point counts only where both of its values can be drawn.
fn extents(chart: &Chart, y_count: usize) -> (Extent, Extent) {
    let shown = |&&(x, y): &&(f64, f64)| {
        super::scale::drawable(chart.x.scale, x) && super::scale::drawable(chart.y.scale, y)
    };
    let points = || chart.series.iter().flat_map(|series| &series.points).filter(shown);
    let marks = |axis| chart.marks.iter().filter(move |mark| mark.axis == axis).map(|mark| mark.at);
    let x = Extent::of(&chart.x, points().map(|point| point.0).chain(marks(MarkAxis::X)));
    let y = Extent::of(&chart.y, points().map(|point| point.1).chain(marks(MarkAxis::Y)));
    (x, y.rounded(&chart.y, y_count))
}

/// As many ticks as their labels leave room for.
fn x_ticks(x: &Extent, most: usize, room: f64) -> Ticks {
    let fits = |ticks: &Ticks| (widest(ticks) + 14.0) * ticks.labelled.len() as f64 <= room;
    let candidates = (2..=most).rev().map(|count| x.ticks(count));
    let mut last = Ticks::default();
    for ticks in candidates {
        if fits(&ticks) {
            return ticks;
        }
        last = ticks;
    }
    last
}

fn widest(ticks: &Ticks) -> f64 {
    ticks.labelled.iter().map(|(_, label)| width(label, LETTERS)).fold(0.0, f64::max)
}
