//! Least squares with no unknown below 0. Two ways to the same minimum: many unknowns of one regular system, and few of
//! a system that may be singular.

use nalgebra::{DMatrix, DVector};

/// Minimum of `½ xᵀMx − bᵀx` over x ≥ 0, M positive definite: one coordinate after the other, which converges for every
/// convex quadratic with bounds.
pub(crate) fn by_coordinates(matrix: &[Vec<f64>], right: &[f64]) -> Vec<f64> {
    const SWEEPS: usize = 20_000;
    let mut x = vec![0.0; right.len()];
    for _ in 0..SWEEPS {
        let mut moved = 0.0f64;
        for i in 0..x.len() {
            if matrix[i][i] > 0.0 {
                let rest: f64 =
                    matrix[i].iter().zip(&x).map(|(m, x)| m * x).sum::<f64>() - matrix[i][i] * x[i];
                let found = ((right[i] - rest) / matrix[i][i]).max(0.0);
                moved = moved.max((found - x[i]).abs());
                x[i] = found;
            }
        }
        if moved < 1e-9 {
            break;
        }
    }
    x
}

/// The weighted least-squares solution of `rows · x = targets` over those of the columns that leaves no negative x and
/// least error, by trying all subsets of them. `scale` is the size of each column; one of size 0 has x = 0. `None` when
/// no subset has a solution.
pub(crate) fn by_subsets<const N: usize>(
    rows: &[[f64; N]],
    targets: &[f64],
    weights: &[f64],
    scale: [f64; N],
) -> Option<[f64; N]> {
    let mut best: Option<(f64, [f64; N])> = None;
    for subset in 1u32..1 << N {
        let columns: Vec<usize> = (0..N).filter(|column| subset >> column & 1 == 1).collect();
        if columns.iter().any(|&column| scale[column] <= 0.0) {
            continue;
        }
        let Some(solved) = least_squares(rows, targets, weights, scale, &columns) else { continue };
        let error = |((target, row), weight): ((&f64, &[f64; N]), &f64)| {
            let predicted: f64 = row.iter().zip(&solved).map(|(x, c)| x * c).sum();
            weight * (target - predicted).powi(2)
        };
        let error: f64 = targets.iter().zip(rows).zip(weights).map(error).sum();
        if solved.iter().all(|c| *c >= 0.0 && c.is_finite()) && best.is_none_or(|(least, _)| error < least) {
            best = Some((error, solved));
        }
    }
    best.map(|(_, solved)| solved)
}

fn least_squares<const N: usize>(
    rows: &[[f64; N]],
    targets: &[f64],
    weights: &[f64],
    scale: [f64; N],
    columns: &[usize],
) -> Option<[f64; N]> {
    if rows.len() < columns.len() {
        return None;
    }
    let root = |index: usize| weights[index].sqrt();
    let design = DMatrix::from_fn(rows.len(), columns.len(), |row, column| {
        root(row) * rows[row][columns[column]] / scale[columns[column]]
    });
    let target = DVector::from_fn(rows.len(), |row, _| root(row) * targets[row]);
    let solution = design.svd(true, true).solve(&target, f64::EPSILON).ok()?;
    let mut solved = [0.0; N];
    columns.iter().zip(solution.iter()).for_each(|(&column, c)| solved[column] = c / scale[column]);
    Some(solved)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn bounded_least_squares_by_hand() {
        // Unbounded: x = (2, −1); bounded at 0 in the second: x₁ = 3/2.
        let matrix = vec![vec![2.0, 1.0], vec![1.0, 1.0]];
        assert_eq!(by_coordinates(&matrix, &[3.0, 1.0]), [1.5, 0.0]);
    }

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

        /// Both ways lead to the one minimum of a regular system.
        #[test]
        fn both_ways_agree(
            rows in prop::collection::vec(prop::array::uniform3(-1.0..1.0f64), 12),
            targets in prop::collection::vec(-1.0..1.0f64, 12),
        ) {
            let weights = vec![1.0; rows.len()];
            let matrix: Vec<Vec<f64>> = (0..3)
                .map(|i| (0..3).map(|j| rows.iter().map(|row| row[i] * row[j]).sum()).collect())
                .collect();
            let right: Vec<f64> =
                (0..3).map(|i| rows.iter().zip(&targets).map(|(row, target)| row[i] * target).sum()).collect();
            let regular = nalgebra::Matrix3::from_fn(|i, j| matrix[i][j]).symmetric_eigenvalues().min() > 0.1;
            prop_assume!(regular);
            let coordinates = by_coordinates(&matrix, &right);
            // No subset at all, x = 0, is the minimum where all correlations are negative: no solution is found then.
            match by_subsets(&rows, &targets, &weights, [1.0; 3]) {
                Some(subsets) => {
                    for (found, expected) in subsets.iter().zip(&coordinates) {
                        // The sweeps end at steps of 1e-9; their sum is larger by the condition number, 120 at most.
                        prop_assert!((found - expected).abs() < 1e-6, "{:?} {:?}", subsets, coordinates);
                    }
                }
                None => prop_assert_eq!(coordinates, vec![0.0; 3]),
            }
        }
    }
}
