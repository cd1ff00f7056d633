//! A multiplier over distance in the form that the loop over pixels evaluates: a polynomial, times a table where
//! the law is not a polynomial.

use super::{DistanceGain, DistanceTable};

/// A distance law, `s(d) = P(d) t(d)`, d in metres. The polynomial holds the valid range and continues as d²
/// outside it, where the table is constant.
#[derive(Clone, Debug, PartialEq)]
pub struct DistanceLaw {
    /// P, evaluated by the loop itself.
    pub(crate) polynomial: DistanceGain,
    /// t; none for laws that are polynomials.
    pub(crate) table: Option<DistanceTable>,
}

impl From<DistanceGain> for DistanceLaw {
    fn from(polynomial: DistanceGain) -> Self {
        Self { polynomial, table: None }
    }
}

impl DistanceLaw {
    /// The law that leaves every amplitude as it is.
    pub(crate) const ONE: Self = Self { polynomial: DistanceGain::ONE, table: None };

    /// The multiplier at one distance (m); NaN for NaN.
    #[must_use]
    pub fn at(&self, distance_m: f32) -> f32 {
        self.table.as_ref().map_or(1.0, |table| table.at(distance_m)) * self.polynomial.at(distance_m)
    }

    /// True where there is a table, whose values [`Self::scale`] multiplies by.
    #[must_use]
    pub(crate) fn has_table(&self) -> bool {
        self.table.is_some()
    }

    /// Multiplies `gains` by the table's values: what the polynomial does not tell. The slices have the same length.
    pub(crate) fn scale(&self, distances_m: &[f32], gains: &mut [f32]) {
        if let Some(table) = &self.table {
            table.scale(distances_m, gains);
        }
    }

    /// Writes `s′/s` (per m) and `s″/s` (per m²) at each distance. The slices have the same length.
    pub(crate) fn relative_derivatives(&self, distances_m: &[f32], slope: &mut [f32], curvature: &mut [f32]) {
        of_the_polynomial(&self.polynomial, distances_m, slope, curvature);
        if let Some(table) = &self.table {
            times_the_table(table, distances_m, slope, curvature);
        }
    }
}

#[multiversion::multiversion(targets("x86_64+avx512f+avx512bw+avx512vl+avx512dq", "x86_64+avx2"))]
fn of_the_polynomial(law: &DistanceGain, distances_m: &[f32], slope: &mut [f32], curvature: &mut [f32]) {
    for ((&d, slope), curvature) in distances_m.iter().zip(slope).zip(curvature) {
        let [s, s1, s2] = law.derivatives(d);
        *slope = s1 / s;
        *curvature = s2 / s;
    }
}

/// `(st)″ / st = s″/s + 2 (s′/s)(t′/t) + t″/t`.
#[multiversion::multiversion(targets("x86_64+avx512f+avx512bw+avx512vl+avx512dq", "x86_64+avx2"))]
fn times_the_table(table: &DistanceTable, distances_m: &[f32], slope: &mut [f32], curvature: &mut [f32]) {
    for ((&d, slope), curvature) in distances_m.iter().zip(slope).zip(curvature) {
        let [t, t1, t2] = table.derivatives(d);
        *curvature += 2.0 * *slope * (t1 / t) + t2 / t;
        *slope += t1 / t;
    }
}
