//! The exponent of the distance, range by range: where it differs, the relation is no power.

use serde::Serialize;

use super::columns::{Request, thirds};
use super::effect::Estimate;
use super::sample::Observed;

/// An exponent of d within a range of distances.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct RangeExponent {
    /// Nearest distance, m.
    pub from_m: f64,
    /// Farthest distance, m.
    pub to_m: f64,
    /// The exponent.
    pub exponent: Estimate,
}

/// The exponent of d in thirds of the pixels; thirds that do not determine it are left out.
pub(super) fn by_distance(request: &Request<'_>, rows: &[Observed]) -> Vec<RangeExponent> {
    let of_third = |rows: Vec<Observed>| {
        let (from, to) = (rows.first()?.distance_m, rows.last()?.distance_m);
        let coefficient = request.fit(&rows).ok()?.distance.ok()?;
        let exponent = Estimate::from(&coefficient);
        Some(RangeExponent { from_m: f64::from(from), to_m: f64::from(to), exponent })
    };
    thirds(rows).into_iter().filter_map(of_third).collect()
}
