//! What one image of a pixel is of another: ln(scaled / raw) on ln t, ln d and r². The material cancels.

use serde::Serialize;

use super::columns::{Fitted, RADIAL, Request, TIME};
use super::effect::Estimate;
use super::limits::SAME_TIME_RATIO;
use super::ranges::{RangeExponent, by_distance};
use super::sample::Observed;
use super::unavailable::Outcome;
use crate::numerics::robust::Loss;
use crate::numerics::statistics::median;

/// Integration times that are listed, shortest first.
const TIME_GROUPS: usize = 16;
/// A residual below this is rounding: one image was computed from the other.
const EXACT: f64 = 1e-5;

/// How a scaled image follows from a raw one.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Scaling {
    /// Exponent of t in scaled/raw: −1 takes the integration time out.
    #[serde(serialize_with = "crate::outcome_json::serialize")]
    pub time: Outcome<Estimate>,
    /// Exponent of d in scaled/raw: 2 takes the inverse-square law out.
    #[serde(serialize_with = "crate::outcome_json::serialize")]
    pub distance: Outcome<Estimate>,
    /// The part that depends on the place in the image.
    #[serde(serialize_with = "crate::outcome_json::serialize")]
    pub radial: Outcome<RadialTerm>,
    /// Exponent of the raw amplitude in the scaled one: 1 is linear, 0.5 a square root. `None` where it was taken
    /// to be 1.
    pub gamma: Option<Estimate>,
    /// scaled/raw at each integration time, distance and place taken out, relative to the longest time.
    pub time_groups: Vec<TimeGroup>,
    /// Exponent of d in scaled/raw in the nearest, the middle and the farthest third of the pixels.
    pub by_distance: Vec<RangeExponent>,
    /// Standard deviation of ln(scaled/raw) around the fit, 1.4826 MAD.
    pub residual: f64,
    /// The same, root mean square: outliers count.
    pub residual_rms: f64,
    /// True when the residual is mere rounding: one image was computed from the other.
    pub exact: bool,
    /// Pixels that entered.
    pub observations: usize,
    /// Share of the valid pixels that entered, 0..=1.
    pub used_fraction: f64,
}

/// `exp(Σ c_k r^2k)`, 1 at the principal point.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RadialTerm {
    /// Coefficients of r², r⁴ and r⁶ in ln(scaled/raw).
    pub coefficients: Vec<Estimate>,
    /// The term at r = 1, the corner of an image with the principal point at its centre; a factor.
    pub corner_factor: Estimate,
    /// The largest r² among the pixels.
    pub largest_radius2: f64,
}

/// scaled/raw at one integration time.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct TimeGroup {
    /// The time, µs.
    pub time_us: f64,
    /// Median of scaled/raw, relative to that at the longest time.
    pub ratio: f64,
    /// Pixels of the sample.
    pub observations: usize,
}

/// Which two images are compared.
pub(super) struct Pair<'a> {
    pub(super) raw: &'a dyn Fn(&Observed) -> f32,
    pub(super) scaled: &'a dyn Fn(&Observed) -> f32,
    /// Fit the exponent of the raw image too.
    pub(super) gamma: bool,
}

impl Scaling {
    pub(super) fn fit(all: &[Observed], pair: &Pair<'_>) -> Outcome<Self> {
        let level = |row: &Observed| f64::from((pair.raw)(row));
        let request = Request {
            of: "the scene",
            response: &|row| f64::from((pair.scaled)(row)).ln() - level(row).ln(),
            group: &|_| 0,
            level: if pair.gamma { Some(&level) } else { None },
            radial_terms: RADIAL.len(),
            loss: Loss::Tukey,
        };
        let fitted = request.fit(all)?;
        let estimate = |outcome: &Outcome<_>| outcome.as_ref().map(Estimate::from).map_err(Clone::clone);
        Ok(Self {
            time: estimate(&fitted.time),
            distance: estimate(&fitted.distance),
            radial: radial(&fitted),
            gamma: fitted.level.as_ref().map(|level| Estimate::from(level).plus(1.0)),
            time_groups: time_groups(&fitted),
            by_distance: if fitted.distance.is_ok() {
                by_distance(&request, &fitted.rows)
            } else {
                Vec::new()
            },
            residual: fitted.fit.residual_sigma,
            residual_rms: fitted.fit.residual_rms,
            exact: fitted.fit.residual_sigma < EXACT,
            observations: fitted.fit.rows,
            used_fraction: fitted.fit.rows as f64 / all.len().max(1) as f64,
        })
    }
}

/// The radial polynomial; the variance of its sum at r = 1 is the sum of the covariances.
fn radial(fitted: &Fitted) -> Outcome<RadialTerm> {
    let terms = fitted.radial.as_ref().map_err(Clone::clone)?;
    let at: Vec<usize> = (fitted.fit.coefficients.iter().enumerate())
        .filter(|(_, coefficient)| RADIAL.contains(&coefficient.column.as_str()))
        .map(|(index, _)| index)
        .collect();
    let variance: f64 =
        at.iter().flat_map(|&i| at.iter().map(move |&j| (i, j))).map(|ij| fitted.fit.covariance[ij]).sum();
    // Student's quantile, as the coefficients have it.
    let t = terms.first().map_or(0.0, |c| (c.high_95 - c.value) / c.standard_error.max(f64::MIN_POSITIVE));
    let ln: f64 = terms.iter().map(|coefficient| coefficient.value).sum();
    let half_width = t * variance.max(0.0).sqrt();
    Ok(RadialTerm {
        coefficients: terms.iter().map(Estimate::from).collect(),
        corner_factor: Estimate {
            value: ln.exp(),
            low_95: (ln - half_width).exp(),
            high_95: (ln + half_width).exp(),
        },
        largest_radius2: fitted.rows.iter().map(|row| f64::from(row.radius2)).fold(0.0, f64::max),
    })
}

/// Medians of the partial residuals (the fit without its term in t) by time. Empty where times do not vary.
fn time_groups(fitted: &Fitted) -> Vec<TimeGroup> {
    let Some(exponent) = fitted.fit.coefficient(TIME) else { return Vec::new() };
    let mut partial: Vec<(f64, f64)> = (fitted.rows.iter().zip(&fitted.fit.residuals))
        .filter(|(_, residual)| !residual.is_nan())
        .map(|(row, residual)| {
            (f64::from(row.time_us), residual + exponent.value * f64::from(row.time_us).ln())
        })
        .collect();
    partial.sort_by(|a, b| a.0.total_cmp(&b.0));
    let groups = partial.chunk_by(|a, b| b.0 < SAME_TIME_RATIO * a.0);
    let medians: Vec<(f64, f64, usize)> = groups
        .filter_map(|group| {
            let mut values: Vec<f64> = group.iter().map(|(_, value)| *value).collect();
            Some((group[0].0, median(&mut values)?, group.len()))
        })
        .collect();
    let Some(&(_, longest, _)) = medians.last() else { return Vec::new() };
    let group = |&(time_us, value, observations): &(f64, f64, usize)| TimeGroup {
        time_us,
        ratio: (value - longest).exp(),
        observations,
    };
    medians.iter().take(TIME_GROUPS).map(group).collect()
}
