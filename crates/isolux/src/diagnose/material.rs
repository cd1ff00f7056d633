//! Pixels of one material at several distances and times: by target label, by vendor amplitude, or all alike.

use serde::Serialize;

use super::columns::{Fitted, Request};
use super::effect::Estimate;
use super::ranges::{RangeExponent, by_distance};
use super::sample::Observed;
use super::scaling::Scaling;
use super::unavailable::{Outcome, Unavailable};
use crate::numerics::robust::Loss;
use crate::numerics::statistics::quantile;

/// Vendor amplitudes of at most this many different values group by value, others by bins of 5 %.
const VENDOR_VALUES: usize = 256;
const VENDOR_BIN_RATIO: f64 = 1.05;
/// A vendor amplitude that is the raw one times powers of t and r, within this residual and without this exponent
/// of d, is no measure of material.
const SCALED_RESIDUAL: f64 = 0.1;
const SCALED_DISTANCE: f64 = 0.1;

/// How the amplitude of one material, or of what is taken for one, goes with t, d and r².
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MaterialFit {
    /// The target label, where there is one.
    pub label: Option<u8>,
    /// d ln A / d ln t.
    #[serde(serialize_with = "crate::outcome_json::serialize")]
    pub time: Outcome<Estimate>,
    /// d ln A / d ln d.
    #[serde(serialize_with = "crate::outcome_json::serialize")]
    pub distance: Outcome<Estimate>,
    /// d ln A / d r²; not fitted for pixels grouped by vendor amplitude.
    #[serde(serialize_with = "crate::outcome_json::serialize")]
    pub radius: Outcome<Estimate>,
    /// Exponent of d in the nearest, the middle and the farthest third of the pixels.
    pub by_distance: Vec<RangeExponent>,
    /// Standard deviation of ln A around the fit, 1.4826 MAD.
    pub residual: f64,
    /// The same, root mean square: outliers count.
    pub residual_rms: f64,
    /// Pixels that entered.
    pub observations: usize,
    /// 5 % and 95 % quantiles of their distances, m; `None` without distances.
    pub distances_m: Option<[f64; 2]>,
}

/// The fits that need to know, or to assume, what is one material.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Material {
    /// One for each target label that has enough pixels, in the order of the labels.
    pub targets: Vec<MaterialFit>,
    /// Pixels of one vendor amplitude taken for one reflectivity. Least squares: the average over all distances,
    /// also where the relation is no power.
    #[serde(serialize_with = "crate::outcome_json::serialize")]
    pub vendor_reflectivity: Outcome<MaterialFit>,
    /// All pixels taken for one material: no evidence, but what a naive regression would find.
    #[serde(serialize_with = "crate::outcome_json::serialize")]
    pub mixed: Outcome<MaterialFit>,
}

impl Material {
    pub(super) fn fit(all: &[Observed], labelled: &[Observed], vendor: &Outcome<Scaling>) -> Self {
        let targets = (1..=u8::MAX).filter_map(|label| {
            let rows: Vec<Observed> = labelled.iter().copied().filter(|row| row.label == label).collect();
            let of = format!("target {label}");
            let fit = request(&of, &|_| 0, 1, Loss::Tukey);
            fit.fit(&rows).ok().map(|fitted| MaterialFit::new(Some(label), &fitted, &fit))
        });
        Self {
            targets: targets.collect(),
            vendor_reflectivity: vendor_groups(all, vendor),
            mixed: {
                let fit = request("the scene", &|_| 0, 1, Loss::Tukey);
                fit.fit(all).map(|fitted| MaterialFit::new(None, &fitted, &fit))
            },
        }
    }

    /// The target whose amplitude is explained best: gloss and wrong labels spoil the others.
    pub(super) fn best_target(&self) -> Option<&MaterialFit> {
        self.targets.iter().min_by(|a, b| a.residual.total_cmp(&b.residual))
    }
}

fn request<'a>(
    of: &'a str,
    group: &'a dyn Fn(&Observed) -> u32,
    radial_terms: usize,
    loss: Loss,
) -> Request<'a> {
    Request { of, response: &|row| f64::from(row.amplitude).ln(), group, level: None, radial_terms, loss }
}

fn vendor_groups(all: &[Observed], vendor: &Outcome<Scaling>) -> Outcome<MaterialFit> {
    let scaling = vendor.as_ref().map_err(Clone::clone)?;
    let flat = |distance: &Estimate| distance.value.abs() < SCALED_DISTANCE;
    if scaling.residual < SCALED_RESIDUAL && scaling.distance.as_ref().map_or(true, flat) {
        return Err(Unavailable::VendorIsNoMaterial);
    }
    let rows: Vec<Observed> = all.iter().copied().filter(|row| row.vendor > 0.0).collect();
    let mut values: Vec<u32> = rows.iter().map(|row| row.vendor.to_bits()).collect();
    values.sort_unstable();
    values.dedup();
    let by_value = values.len() <= VENDOR_VALUES;
    let group = move |row: &Observed| match by_value {
        true => row.vendor.to_bits(),
        // Logarithms of f32 lie within ±104; the offset keeps the bins positive.
        false => ((f64::from(row.vendor).ln() + 200.0) / VENDOR_BIN_RATIO.ln()) as u32,
    };
    let fit = request("pixels of one vendor amplitude", &group, 0, Loss::LeastSquares);
    fit.fit(&rows).map(|fitted| MaterialFit::new(None, &fitted, &fit))
}

impl MaterialFit {
    fn new(label: Option<u8>, fitted: &Fitted, request: &Request<'_>) -> Self {
        let estimate = |outcome: &Outcome<_>| outcome.as_ref().map(Estimate::from).map_err(Clone::clone);
        let radius = fitted.radial.as_ref().map_err(Clone::clone);
        Self {
            label,
            time: estimate(&fitted.time),
            distance: estimate(&fitted.distance),
            radius: radius
                .and_then(|terms| terms.first().map(Estimate::from).ok_or(Unavailable::MaterialUnknown)),
            by_distance: by_distance(request, &fitted.rows),
            residual: fitted.fit.residual_sigma,
            residual_rms: fitted.fit.residual_rms,
            observations: fitted.fit.rows,
            distances_m: span(&fitted.rows),
        }
    }
}

fn span(rows: &[Observed]) -> Option<[f64; 2]> {
    let known = rows.iter().map(|row| f64::from(row.distance_m)).filter(|distance_m| !distance_m.is_nan());
    let mut distances: Vec<f64> = known.collect();
    Some([quantile(&mut distances, 0.05)?, quantile(&mut distances, 0.95)?])
}
