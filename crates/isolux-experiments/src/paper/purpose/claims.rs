//! The conclusion's claim, detector by detector.

use isolux_report::page::{Claim, Verdict};

use super::experiments::Experiments;
use super::metrics::{CORNERS, EDGES, Metric, OTSU_DRIFT, SERVED_SHARE, THRESHOLD, above_noise, at_time};
use super::stability::{Point, Stability};
use super::sweep::{CHART_TIMES_US, Variant};
use crate::paper::parts::verdict;

/// Share of the conditions that a stable setting serves at least.
const STABLE_SHARE: f64 = 0.75;
/// Before standardization it serves at most this share of as many.
const CLEAR_SHARE: f64 = 0.7;
/// Otsu's level counts as stable when it moves less than this on average, natural-log units: 10 %.
const STABLE_LEVEL_LN: f64 = 0.1;

/// A short integration time at which the raw signal is still good, µs.
const SHORT_US: f64 = 2000.0;

/// Who is asked, over what: the sweep, and its points that count.
type Asked<'a> = (&'static str, &'a Stability, Vec<Point>);

/// Every claim, over the integration times and over the distances.
pub(super) fn claims(experiments: &Experiments) -> Vec<Claim> {
    let times: Vec<Asked<'_>> = [("desk", &experiments.desk), ("shelf", &experiments.shelf)]
        .map(|(name, sweep)| (name, sweep, sweep.points.clone()))
        .into();
    let distances: Vec<Asked<'_>> =
        vec![("board", &experiments.board, at_time(&experiments.board.points, CHART_TIMES_US[1]))];
    let detectors = [
        (THRESHOLD, "threshold", "One fixed threshold"),
        (EDGES, "canny", "One Canny setting"),
        (CORNERS, "corners", "One FAST setting"),
    ];
    let mut claims = Vec::new();
    for (metric, id, who) in detectors {
        claims.push(served(&metric, &format!("one-{id}-for-all-times"), who, "integration times", &times));
        claims.push(served(&metric, &format!("one-{id}-for-all-distances"), who, "distances", &distances));
    }
    claims.push(otsu_level(
        "otsu-level-over-times",
        "integration times from 1 ms",
        &[above_noise(&experiments.desk.points), above_noise(&experiments.shelf.points)],
    ));
    let board = at_time(&experiments.board.points, CHART_TIMES_US[1]);
    claims.push(otsu_level("otsu-level-over-distances", "distances", &[board]));
    claims.push(ported_noise(&experiments.desk));
    claims
}

/// In how many of the conditions does the setting serve?
fn served(metric: &Metric, id: &str, who: &str, over: &str, asked: &[Asked<'_>]) -> Claim {
    let share = |variant| {
        let served = asked.iter().map(|(_, sweep, points)| metric.served(sweep, points, variant).len());
        served.sum::<usize>() as f64 / asked.iter().map(|(_, _, points)| points.len()).sum::<usize>() as f64
    };
    let (before, after) = (share(Variant::Raw), share(Variant::Standardized));
    let ranges = |variant| {
        let range = |(name, sweep, points): &Asked<'_>| {
            format!("{name} {}", range(&metric.served(sweep, points, variant), points))
        };
        asked.iter().map(range).collect::<Vec<_>>().join(", ")
    };
    Claim {
        id: id.to_owned(),
        statement: format!("{who} serves most {over} after standardization, and clearly fewer before."),
        measured: format!(
            "Within {:.0} % of its figure at the reference in {:.0} % of the conditions after ({}), {:.0} % before ({}).",
            100.0 * (1.0 - SERVED_SHARE),
            100.0 * after,
            ranges(Variant::Standardized),
            100.0 * before,
            ranges(Variant::Raw),
        ),
        value: after,
        verdict: if after < STABLE_SHARE {
            let cause =
                "the short integration times are lost: the distance step ports its noise into the image";
            Verdict::Fails(cause.to_owned())
        } else if before > CLEAR_SHARE * after {
            Verdict::Fails("raw images are served nearly as often, so it was solvable before".to_owned())
        } else {
            Verdict::Holds
        },
    }
}

/// The paper's own warning (section 3), in the image where it hurts most.
fn ported_noise(desk: &Stability) -> Claim {
    let points = at_time(&desk.points, SHORT_US);
    let f1 = |variant| EDGES.mean_and_worst(&points, variant).0;
    let (raw, time_only, standardized) = (f1(Variant::Raw), f1(Variant::TimeOnly), f1(Variant::Standardized));
    Claim {
        id: "distance-step-costs-edges-at-short-times".to_owned(),
        statement: "At low integration times the noise of the distance is ported into the scaled image."
            .to_owned(),
        measured: format!(
            "Desk at {:.1} ms: edge F1 {time_only:.2} after the time step alone, {standardized:.2} after the whole \
             chain, {raw:.2} raw.",
            SHORT_US / 1000.0
        ),
        value: standardized - time_only,
        verdict: verdict(standardized < time_only, "the whole chain is no worse than the time step alone"),
    }
}

/// The conditions that are served: from, to, and whether any between them is not.
fn range(served: &[Point], all: &[Point]) -> String {
    let (Some(first), Some(last)) = (served.first(), served.last()) else { return "none".to_owned() };
    let between = |point: &&Point| {
        let key = |point: &Point| {
            (point.conditions.distance_m.unwrap_or(0.0), point.conditions.integration_time_us)
        };
        key(point) >= key(first) && key(point) <= key(last)
    };
    let gaps = all.iter().filter(between).count() - served.len();
    let label = |point: &Point| match point.conditions.distance_m {
        Some(distance_m) => format!("{distance_m} m"),
        None => format!("{:.1} ms", point.conditions.integration_time_us / 1000.0),
    };
    let gaps = if gaps > 0 { format!(" but for {gaps}") } else { String::new() };
    format!("{} to {}{gaps}", label(first), label(last))
}

fn otsu_level(id: &str, over: &str, asked: &[Vec<Point>]) -> Claim {
    let points = asked.concat();
    let drift = |variant| OTSU_DRIFT.mean_and_worst(&points, variant);
    let ((before, before_worst), (after, after_worst)) = (drift(Variant::Raw), drift(Variant::Standardized));
    Claim {
        id: id.to_owned(),
        statement: format!("Otsu's level stays over the {over} after standardization."),
        measured: format!(
            "It moves by a factor of {:.2} on average and {:.2} at most after, {:.2} and {:.2} before.",
            after.exp(),
            after_worst.exp(),
            before.exp(),
            before_worst.exp()
        ),
        value: after,
        verdict: verdict(
            after < STABLE_LEVEL_LN && after < before,
            "the level moves by more than a tenth on average",
        ),
    }
}
