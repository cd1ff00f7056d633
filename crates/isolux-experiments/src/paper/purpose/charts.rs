//! Curves over the integration time and over the distance, before and after.

use isolux_report::page::{Axis, Chart, Mark, MarkAxis, Scale, Series, Stroke};

use super::experiments::Experiments;
use super::metrics::{CORNERS, EDGES, Metric, OTSU, THRESHOLD, at_time};
use super::stability::{Figures, Point};
use super::sweep::{CHART_TIMES_US, Variant};
use crate::paper::parts::axis;

const OTSU_LEVEL: Metric = Metric {
    name: "Otsu's level relative to the reference",
    of: |figures: &Figures| figures.otsu_ratio,
    smaller_is_better: false,
};

/// What the charts show: metric, name in identifiers, what it is in words.
const SHOWN: [(Metric, &str, &str); 5] = [
    (THRESHOLD, "threshold", "Overlap (IoU) of the mask of one threshold with the reference's"),
    (EDGES, "edges", "F1 of the edges of one Canny setting against the reference's, within 1 px"),
    (OTSU, "otsu", "Overlap (IoU) of the mask of Otsu's rule with the reference's"),
    (OTSU_LEVEL, "otsu-level", "Otsu's level relative to the reference's"),
    (CORNERS, "corners", "Repeatability of the FAST corners of one setting, within 1.5 px"),
];

/// One chart a figure over the integration times, both scenes.
pub(super) fn over_time(experiments: &Experiments) -> Vec<Chart> {
    let scenes = [("desk", &experiments.desk), ("shelf", &experiments.shelf)];
    let chart = |(metric, id, what): &(Metric, &str, &str)| {
        let series = scenes.iter().flat_map(|(scene, sweep)| {
            curves(metric, scene, &sweep.points, |point| point.conditions.integration_time_us / 1000.0)
        });
        let series: Vec<Series> = series.collect();
        Chart {
            id: format!("purpose-time-{id}"),
            caption: format!("{what}, two still scenes over the integration time, before and after."),
            alt: alt(metric, "integration time", &series),
            x: axis("integration time in ms", Scale::Log),
            y: y_axis(metric),
            series,
            marks: vec![reference_mark(8.2, "tuned here")],
        }
    };
    SHOWN.iter().map(chart).collect()
}

/// One chart a figure over the distances of the board, both integration times.
pub(super) fn over_distance(experiments: &Experiments) -> Vec<Chart> {
    let chart = |(metric, id, what): &(Metric, &str, &str)| {
        let series = CHART_TIMES_US.iter().rev().flat_map(|time_us| {
            let points = at_time(&experiments.board.points, *time_us);
            let name = format!("{:.1} ms", time_us / 1000.0);
            curves(metric, &name, &points, |point| point.conditions.distance_m.unwrap_or(f64::NAN))
        });
        let series: Vec<Series> = series.collect();
        Chart {
            id: format!("purpose-distance-{id}"),
            caption: format!("{what}, the board over its distance, before and after."),
            alt: alt(metric, "distance", &series),
            x: axis("distance in m", Scale::Linear),
            y: y_axis(metric),
            series,
            marks: vec![reference_mark(0.75, "tuned here (8.2 ms)")],
        }
    };
    SHOWN.iter().map(chart).collect()
}

/// Dashed before, solid after.
fn curves(metric: &Metric, name: &str, points: &[Point], x: impl Fn(&Point) -> f64) -> [Series; 2] {
    [(Variant::Raw, Stroke::Dashed), (Variant::Standardized, Stroke::SolidPoints)].map(|(variant, stroke)| {
        Series {
            name: format!("{name}, {}", variant.name()),
            points: points.iter().map(|point| (x(point), metric.at(point, variant))).collect(),
            stroke,
        }
    })
}

fn y_axis(metric: &Metric) -> Axis {
    if metric.name == OTSU_LEVEL.name {
        axis(metric.name, Scale::Log)
    } else {
        Axis { range: Some((0.0, 1.0)), ..axis(metric.name, Scale::Linear) }
    }
}

/// Lowest and highest value of each curve.
fn alt(metric: &Metric, over: &str, series: &[Series]) -> String {
    let ranges = series.iter().map(|series| {
        let values = series.points.iter().map(|(_, value)| *value);
        let (low, high) =
            values.fold((f64::INFINITY, 0.0f64), |(low, high), value| (low.min(value), high.max(value)));
        format!("{} from {low:.2} to {high:.2}", series.name)
    });
    format!("{} over the {over}: {}.", metric.name, ranges.collect::<Vec<_>>().join("; "))
}

fn reference_mark(at: f64, label: &str) -> Mark {
    Mark { axis: MarkAxis::X, at, label: label.to_owned() }
}
