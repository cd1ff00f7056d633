//! Where the parts of a chart are, for one width of the page.

use super::curves::{self, Curve};
use super::marks::{self, MarkLabel};
use super::scale::Extent;
use super::text::{Anchor, LETTERS, LINE, width, wrap};
use super::ticks::Ticks;
use crate::page::{Chart, MarkAxis};

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
            Self::Wide => (7, 5),
            Self::Narrow => (5, 4),
        }
    }
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
    /// One for each series.
    pub(super) curves: Vec<Curve>,
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
        let above = LINE * y_lines.len() as f64 + 8.0;
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
            curves: Vec::new(),
        };
        let curve = |index: usize| {
            curves::curve(&chart.series[index], &layout.x, &layout.y, curves::turn(chart, index))
        };
        layout.curves = (0..chart.series.len()).map(curve).collect();
        layout.label_marks(chart);
        let below = layout.top + plot_height + TICK + LINE;
        layout.height = below + LINE * x_lines.len() as f64 + 6.0;
        let x_label = x_lines.into_iter().enumerate();
        layout.x_label = x_label.map(|(row, text)| (text, below + 3.0 + LINE * (row as f64 + 0.5))).collect();
        layout
    }

    /// Labels of marks: in the frame where there is room, in rows above it otherwise. Moves the frame down for them.
    fn label_marks(&mut self, chart: &Chart) {
        let span = (self.left, self.plot_width);
        let (inner, homeless) =
            marks::beside(chart, (&self.x, &self.y), span, self.plot_height, &self.curves);
        let right = self.left + self.plot_width;
        for text in homeless.iter().flat_map(|text| wrap(text, LETTERS, right)) {
            let at = (right, self.top + LINE / 2.0);
            self.mark_labels.push(MarkLabel { text, at, anchor: Anchor::Right });
            self.top += LINE;
        }
        let (rows, height) = marks::above(chart, &self.x, span, self.width, self.top);
        self.mark_labels.extend(rows);
        self.top += height;
        let lowered = |label: MarkLabel| MarkLabel { at: (label.at.0, label.at.1 + self.top), ..label };
        self.mark_labels.extend(inner.into_iter().map(lowered));
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
