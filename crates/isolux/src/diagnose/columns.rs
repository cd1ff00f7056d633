//! One regression on ln t, ln d and powers of r², with the columns that the rows determine.

use super::limits::{MINIMUM_DISTANCE_RATIO, MINIMUM_FRAME_CLUSTERS, MINIMUM_ROWS, SAME_TIME_RATIO};
use super::sample::Observed;
use super::unavailable::{Outcome, Unavailable};
use crate::numerics::regression::{Coefficient, Intercepts, Regression, RegressionError, RegressionFit, Row};
use crate::numerics::robust::Loss;
use crate::numerics::statistics::quantile;

pub(super) const TIME: &str = "integration time";
pub(super) const DISTANCE: &str = "distance";
pub(super) const LEVEL: &str = "amplitude";
pub(super) const RADIAL: [&str; 3] = ["r²", "r⁴", "r⁶"];

/// What is to be regressed.
pub(super) struct Request<'a> {
    /// Name of the pixels, for messages.
    pub(super) of: &'a str,
    /// NaN where the row does not count.
    pub(super) response: &'a dyn Fn(&Observed) -> f64,
    pub(super) group: &'a dyn Fn(&Observed) -> u32,
    /// The logarithm of this is a column too.
    pub(super) level: Option<&'a dyn Fn(&Observed) -> f64>,
    /// Number of powers of r².
    pub(super) radial_terms: usize,
    pub(super) loss: Loss,
}

/// The fit, and why columns are not in it.
pub(super) struct Fitted {
    pub(super) time: Outcome<Coefficient>,
    pub(super) distance: Outcome<Coefficient>,
    /// Those powers of r² that could be told apart.
    pub(super) radial: Outcome<Vec<Coefficient>>,
    pub(super) level: Option<Coefficient>,
    pub(super) fit: RegressionFit,
    /// The rows, in the order of the fit's residuals.
    pub(super) rows: Vec<Observed>,
}

impl Request<'_> {
    pub(super) fn fit(&self, rows: &[Observed]) -> Outcome<Fitted> {
        let mut rows: Vec<Observed> = rows.iter().copied().filter(|row| self.counts(row)).collect();
        require(&rows)?;
        let mut time = varying_times(&rows);
        if time.is_ok() {
            rows.retain(|row| !row.time_us.is_nan());
        }
        let mut distance = varying_distances(&rows, self.of);
        if distance.is_ok() {
            rows.retain(|row| !row.distance_m.is_nan());
        }
        require(&rows)?;
        let mut radial = Ok(());
        let mut columns: Vec<&str> = Vec::new();
        columns.extend(time.is_ok().then_some(TIME));
        columns.extend(distance.is_ok().then_some(DISTANCE));
        columns.extend(self.level.map(|_| LEVEL));
        columns.extend(&RADIAL[..self.radial_terms]);
        let fit = loop {
            if columns.is_empty() {
                return Err(first_reason([time, distance, radial]));
            }
            match self.regress(&columns, &rows) {
                Ok(fit) => break fit,
                Err(error) => {
                    let (RegressionError::Constant { column } | RegressionError::Dependent { column, .. }) =
                        &error
                    else {
                        return Err(error.into());
                    };
                    let left_out = column.clone();
                    columns.retain(|name| *name != left_out);
                    match left_out.as_str() {
                        TIME => time = Err(error.into()),
                        DISTANCE => distance = Err(error.into()),
                        "r²" => radial = Err(error.into()),
                        _ => {}
                    }
                }
            }
        };
        let find = |name: &str| fit.coefficient(name).cloned().ok_or(Unavailable::NoValidPixels);
        Ok(Fitted {
            time: time.and_then(|()| find(TIME)),
            distance: distance.and_then(|()| find(DISTANCE)),
            radial: radial
                .map(|()| RADIAL.iter().filter_map(|name| fit.coefficient(name).cloned()).collect()),
            level: fit.coefficient(LEVEL).cloned(),
            rows,
            fit,
        })
    }

    fn counts(&self, row: &Observed) -> bool {
        let level = self.level.map_or(1.0, |level| level(row));
        (self.response)(row).is_finite() && level > 0.0 && level.is_finite()
    }

    fn regress(&self, columns: &[&str], rows: &[Observed]) -> Result<RegressionFit, RegressionError> {
        let frames = rows.iter().map(|row| row.frame).collect::<std::collections::HashSet<_>>().len();
        let ways = if frames >= MINIMUM_FRAME_CLUSTERS { 2 } else { 1 };
        let mut regression = Regression::new(columns.iter().copied(), Intercepts::PerGroup);
        for row in rows {
            let values: Vec<f64> = columns.iter().map(|name| self.value(name, row)).collect();
            let clusters = [u32::from(row.block), row.frame];
            regression.push(Row {
                columns: &values,
                response: (self.response)(row),
                weight: 1.0,
                group: (self.group)(row),
                clusters: &clusters[..ways],
            })?;
        }
        regression.fit(self.loss)
    }

    fn value(&self, column: &str, row: &Observed) -> f64 {
        let radius2 = f64::from(row.radius2);
        match column {
            TIME => f64::from(row.time_us).ln(),
            DISTANCE => f64::from(row.distance_m).ln(),
            LEVEL => self.level.map_or(0.0, |level| level(row).ln()),
            "r²" => radius2,
            "r⁴" => radius2.powi(2),
            _ => radius2.powi(3),
        }
    }
}

fn first_reason(outcomes: [Outcome<()>; 3]) -> Unavailable {
    outcomes.into_iter().find_map(Result::err).unwrap_or(Unavailable::NoValidPixels)
}

fn require(rows: &[Observed]) -> Outcome<()> {
    if rows.len() >= MINIMUM_ROWS {
        return Ok(());
    }
    Err(Unavailable::TooFewPixels { found: rows.len(), needed: MINIMUM_ROWS })
}

/// Refuses times that are unknown or all the same.
pub(super) fn varying_times(rows: &[Observed]) -> Outcome<()> {
    let known = || rows.iter().map(|row| row.time_us).filter(|time_us| !time_us.is_nan());
    let (shortest, longest) = (known().fold(f32::INFINITY, f32::min), known().fold(0.0, f32::max));
    if longest == 0.0 {
        return Err(Unavailable::TimeUnknown);
    }
    if f64::from(longest) < SAME_TIME_RATIO * f64::from(shortest) {
        return Err(Unavailable::TimeConstant { time_us: f64::from(longest) });
    }
    Ok(())
}

/// Refuses distances that are unknown or hardly differ.
fn varying_distances(rows: &[Observed], of: &str) -> Outcome<()> {
    let mut known: Vec<f64> =
        rows.iter().map(|row| f64::from(row.distance_m)).filter(|distance_m| !distance_m.is_nan()).collect();
    let (Some(near), Some(far)) = (quantile(&mut known, 0.05), quantile(&mut known, 0.95)) else {
        return Err(Unavailable::NoDistance);
    };
    if far / near < MINIMUM_DISTANCE_RATIO {
        let (of, minimum) = (of.to_owned(), MINIMUM_DISTANCE_RATIO);
        return Err(Unavailable::DistanceSpanTooSmall { of, found: far / near, minimum });
    }
    Ok(())
}

/// The rows in thirds by distance, nearest first; rows without a distance are left out.
pub(super) fn thirds(rows: &[Observed]) -> Vec<Vec<Observed>> {
    let mut sorted: Vec<Observed> = rows.iter().copied().filter(|row| !row.distance_m.is_nan()).collect();
    sorted.sort_by(|a, b| a.distance_m.total_cmp(&b.distance_m));
    sorted.chunks(sorted.len().div_ceil(3).max(1)).map(<[Observed]>::to_vec).collect()
}
