//! Nonlinear least squares: the step of Levenberg (1944) and Marquardt (1963) with numeric derivatives, for fits of a
//! few dozen parameters whose model is cheap.

use nalgebra::{DMatrix, DVector};

/// Residuals beyond this many standard deviations count less and less.
const SOFT_SIGMAS: f64 = 2.0;
/// Step of the numeric derivatives: the error of a one-sided difference, `ε/h + h`, is least near √ε.
const DERIVATIVE_STEP: f64 = 1e-7;
/// Steps that are tried.
const MOST_STEPS: usize = 300;
/// A step that lowers the cost by a smaller share ends the search.
const SETTLED: f64 = 1e-10;
/// Damping at which no step lowers the cost any more: the search has ended.
const LARGEST_DAMPING: f64 = 1e10;

/// Parameters with the least robust cost.
#[derive(Clone, Debug)]
pub(crate) struct Fitted {
    pub(crate) parameters: Vec<f64>,
    /// Sum of [`soft_loss`] over the residuals.
    pub(crate) cost: f64,
}

/// Minimizes the soft-L1 cost of the residuals, which are in standard deviations. `residuals` writes them for
/// parameters; their number must not change. `None` where they are not finite at the start.
pub(crate) fn least_squares(start: &[f64], residuals: impl Fn(&[f64], &mut Vec<f64>)) -> Option<Fitted> {
    let mut parameters = start.to_vec();
    let (mut found, mut trial) = (Vec::new(), Vec::new());
    residuals(&parameters, &mut found);
    let mut least = cost(&found)?;
    let mut damping = 1e-3;
    let mut normal = Normal::new(&parameters, &found, &residuals);
    for _ in 0..MOST_STEPS {
        let step = normal.step(damping);
        let moved: Vec<f64> = match &step {
            Some(step) => parameters.iter().zip(step.iter()).map(|(p, s)| p + s).collect(),
            None => parameters.clone(),
        };
        residuals(&moved, &mut trial);
        match cost(&trial).filter(|cost| step.is_some() && *cost < least) {
            Some(lower) => {
                let gain = (least - lower) / least.max(f64::MIN_POSITIVE);
                (parameters, least) = (moved, lower);
                std::mem::swap(&mut found, &mut trial);
                damping = (0.3 * damping).max(1e-12);
                if gain < SETTLED {
                    break;
                }
                normal = Normal::new(&parameters, &found, &residuals);
            }
            None if damping > LARGEST_DAMPING => break,
            None => damping *= 4.0,
        }
    }
    Some(Fitted { parameters, cost: least })
}

/// Soft-L1 loss of a residual in standard deviations, `2 s² (√(1 + r²/s²) − 1)`, s = [`SOFT_SIGMAS`]: the square of a
/// small one, the size of a large one.
pub(crate) fn soft_loss(residual: f64) -> f64 {
    let square = SOFT_SIGMAS * SOFT_SIGMAS;
    2.0 * square * ((1.0 + residual * residual / square).sqrt() - 1.0)
}

/// The sum of the losses; `None` where it is not finite.
fn cost(residuals: &[f64]) -> Option<f64> {
    let sum: f64 = residuals.iter().copied().map(soft_loss).sum();
    sum.is_finite().then_some(sum)
}

/// The normal equations at one place.
struct Normal {
    gram: DMatrix<f64>,
    gradient: DVector<f64>,
}

impl Normal {
    fn new(parameters: &[f64], at: &[f64], residuals: &impl Fn(&[f64], &mut Vec<f64>)) -> Self {
        let mut jacobian = DMatrix::zeros(at.len(), parameters.len());
        let (mut moved, mut there) = (parameters.to_vec(), Vec::new());
        for (column, &value) in parameters.iter().enumerate() {
            let step = DERIVATIVE_STEP * value.abs().max(1.0);
            moved[column] = value + step;
            residuals(&moved, &mut there);
            moved[column] = value;
            for (row, (there, here)) in there.iter().zip(at).enumerate() {
                jacobian[(row, column)] = (there - here) / step;
            }
        }
        let square = SOFT_SIGMAS * SOFT_SIGMAS;
        let weights = DVector::from_iterator(at.len(), at.iter().map(|r| (1.0 + r * r / square).powf(-0.5)));
        let mut weighted = jacobian.clone();
        for (mut row, weight) in weighted.row_iter_mut().zip(weights.iter()) {
            row *= *weight;
        }
        let gradient = weighted.transpose() * DVector::from_column_slice(at);
        Self { gram: weighted.transpose() * jacobian, gradient }
    }

    /// The step for a damping; `None` where the equations are singular.
    fn step(&self, damping: f64) -> Option<DVector<f64>> {
        let mut damped = self.gram.clone();
        for i in 0..damped.nrows() {
            damped[(i, i)] += damping * self.gram[(i, i)].max(1e-9);
        }
        let step = -damped.cholesky()?.solve(&self.gradient);
        step.iter().all(|s| s.is_finite()).then_some(step)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_decay_is_found_in_spite_of_an_outlier() {
        let model = |p: &[f64], x: f64| p[0].exp() * (-p[1].exp() * x).exp();
        let truth = [1.2, -0.5];
        let rows: Vec<(f64, f64)> = (0..30)
            .map(|i| (0.2 * f64::from(i), model(&truth, 0.2 * f64::from(i)) + if i == 7 { 5.0 } else { 0.0 }))
            .collect();
        let residuals = |p: &[f64], out: &mut Vec<f64>| {
            out.clear();
            out.extend(rows.iter().map(|(x, y)| (y - model(p, *x)) / 0.01));
        };
        let found = least_squares(&[0.0, 0.0], residuals).unwrap();
        // The outlier's influence is that of 2 standard deviations, 0.02, of 30 rows.
        for (found, truth) in found.parameters.iter().zip(truth) {
            assert!((found - truth).abs() < 0.01, "{found} {truth}");
        }
        assert!(least_squares(&[f64::NAN, 0.0], residuals).is_none());
    }
}
