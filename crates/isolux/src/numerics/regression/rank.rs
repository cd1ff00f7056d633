//! Checks that no column is constant or a combination of others.

use nalgebra::DMatrix;

use super::centred::Centred;
use super::error::RegressionError;

/// A column counts as constant when it varies by less than this, relative to its size.
const CONSTANT: f64 = 1e-9;
/// A column counts as dependent when the columns before it leave less than this share of its variance.
const DEPENDENT: f64 = 1e-8;
/// Columns whose part in a dependent one is below this (both of unit length) are not named.
const NAMED: f64 = 1e-3;

/// Condition number of the columns, and the tolerance of each.
pub(super) fn check(
    names: &[String],
    design: &[f64],
    centred: &Centred,
    weights: &[f64],
) -> Result<(f64, Vec<f64>), RegressionError> {
    let columns = names.len();
    let gram = centred.gram(weights);
    let total: f64 = weights.iter().sum();
    for (k, name) in names.iter().enumerate() {
        let size = design.iter().skip(k).step_by(columns).fold(0.0f64, |size, x| size.max(x.abs()));
        if (gram[(k, k)] / total).sqrt() <= CONSTANT * size {
            return Err(RegressionError::Constant { column: name.clone() });
        }
    }
    let unit = DMatrix::from_fn(columns, columns, |i, j| gram[(i, j)] / (gram[(i, i)] * gram[(j, j)]).sqrt());
    for k in 1..columns {
        let before = unit.view((0, 0), (k, k)).into_owned();
        let with = unit.view((0, k), (k, 1)).into_owned();
        let Some(parts) = before.cholesky().map(|factor| factor.solve(&with)) else { continue };
        if 1.0 - (with.transpose() * &parts)[(0, 0)] < DEPENDENT {
            let named = (0..k).filter(|&i| parts[(i, 0)].abs() > NAMED);
            let others = named.map(|i| format!("`{}`", names[i])).collect();
            return Err(RegressionError::Dependent { column: names[k].clone(), others });
        }
    }
    let eigenvalues = unit.clone().symmetric_eigenvalues();
    let condition = (eigenvalues.max() / eigenvalues.min().max(f64::MIN_POSITIVE)).sqrt();
    let inverse = unit.clone().cholesky().map(|factor| factor.inverse()).unwrap_or(unit);
    let tolerances = (0..columns).map(|k| (1.0 / inverse[(k, k)]).clamp(0.0, 1.0)).collect();
    Ok((condition, tolerances))
}
