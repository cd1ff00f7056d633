//! What was tuned, and the means and worst values that come of it.

use isolux_report::page::{Cell, Table};

use super::experiments::Experiments;
use super::metrics::{ALL, Metric, above_noise, at_time};
use super::stability::{Point, Stability};
use super::sweep::{CHART_TIMES_US, Variant};

/// Values this close are equally good: a fifth of what is shown.
const TIE: f64 = 0.002;

/// The settings, chosen once.
pub(super) fn tuning(experiments: &Experiments) -> Table {
    let scenes: [(&str, &Stability); 3] =
        [("desk", &experiments.desk), ("shelf", &experiments.shelf), ("board", &experiments.board)];
    let rows = scenes.iter().flat_map(|(scene, sweep)| {
        Variant::ALL.iter().zip(&sweep.tuned).map(move |(variant, tuned)| {
            let number = |value: f64, decimals| Cell::Number { value, decimals };
            vec![
                Cell::Text(format!("{scene}, {}", variant.name())),
                number(tuned.scale.levels_per_dn, 4),
                number(f64::from(tuned.threshold.level), 0),
                number(f64::from(tuned.canny.upper), 0),
                number(tuned.canny.true_f1, 2),
                number(f64::from(tuned.features.threshold), 0),
                number(tuned.features.count() as f64, 0),
            ]
        })
    });
    Table {
        id: "purpose-settings".to_owned(),
        caption: "The settings, chosen once at the reference by the same rules for every variant.".to_owned(),
        columns: [
            "scene, image",
            "scale in grey levels per DN",
            "threshold in grey levels",
            "Canny's upper threshold",
            "F1 against the true outlines",
            "FAST's threshold in grey levels",
            "corners",
        ]
        .map(str::to_owned)
        .to_vec(),
        rows: rows.collect(),
    }
}

/// Means and worst values over the conditions that are not mostly noise.
pub(super) fn summary(experiments: &Experiments) -> Table {
    let over_distance = |time_us| at_time(&experiments.board.points, time_us);
    let groups = [
        ("desk".to_owned(), above_noise(&experiments.desk.points)),
        ("shelf".to_owned(), above_noise(&experiments.shelf.points)),
        ("board at 8.2 ms".to_owned(), over_distance(CHART_TIMES_US[1])),
        ("board at 2.0 ms".to_owned(), over_distance(CHART_TIMES_US[0])),
    ];
    let caption = "Detectors with one set of parameters, mean and worst over 1 to 27.2 ms (desk, shelf) or 0.6 to 3 m (board). \
                   `time` is the paper's table alone, `chain` the whole standardization. The best of the three is \
                   marked; drift is best when small.";
    table("purpose-summary", caption, &groups)
}

/// The same with the shortest integration times.
pub(super) fn all_times(experiments: &Experiments) -> Table {
    let groups = [
        ("desk".to_owned(), experiments.desk.points.clone()),
        ("shelf".to_owned(), experiments.shelf.points.clone()),
    ];
    let caption = "The same over 0.2 to 27.2 ms: the two shortest images are mostly noise.";
    table("purpose-all-times", caption, &groups)
}

fn table(id: &str, caption: &str, groups: &[(String, Vec<Point>)]) -> Table {
    let mut columns = vec!["experiment: figure".to_owned()];
    for variant in ["raw", "time", "chain"] {
        columns.extend(["mean", "worst"].map(|kind| format!("{variant}, {kind}")));
    }
    let rows = ALL
        .iter()
        .flat_map(|metric| groups.iter().map(move |(experiment, points)| row(metric, experiment, points)));
    Table { id: id.to_owned(), caption: caption.to_owned(), columns, rows: rows.collect() }
}

fn row(metric: &Metric, experiment: &str, points: &[Point]) -> Vec<Cell> {
    let found = Variant::ALL.map(|variant| metric.mean_and_worst(points, variant));
    let best = |pick: fn(&(f64, f64)) -> f64| {
        let values = found.iter().map(pick);
        if metric.smaller_is_better {
            values.fold(f64::INFINITY, f64::min)
        } else {
            values.fold(0.0, f64::max)
        }
    };
    let cell = |value: f64, best: f64| match (value - best).abs() <= TIE {
        true => Cell::Best { value, decimals: 2 },
        false => Cell::Number { value, decimals: 2 },
    };
    let (best_mean, best_worst) = (best(|found| found.0), best(|found| found.1));
    let mut row = vec![Cell::Text(format!("{experiment}: {}", metric.name))];
    row.extend(found.iter().flat_map(|(mean, worst)| [cell(*mean, best_mean), cell(*worst, best_worst)]));
    row
}
