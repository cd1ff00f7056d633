//! Robust weights of residuals: Huber's and Tukey's.

/// Huber's tuning constant: 95 % efficiency at normal errors.
const HUBER: f64 = 1.345;
/// Tukey's, the same efficiency: residuals beyond this many standard deviations do not count (methods, section 4).
pub(crate) const TUKEY_CUTOFF: f64 = 4.685;

/// Tukey's biweight, 0..=1; `share` is the squared residual over the square of the cutoff. 0 for NaN.
#[inline]
pub(crate) fn biweight(share: f64) -> f64 {
    if share < 1.0 { (1.0 - share).powi(2) } else { 0.0 }
}

/// The square of a residual over that of [`TUKEY_CUTOFF`] standard deviations.
pub(crate) fn tukey_share(residual: f64, sigma: f64) -> f64 {
    (residual / (TUKEY_CUTOFF * sigma)).powi(2)
}

/// Tukey's loss, which the biweight belongs to: 0 for no residual, 1 from the cutoff on.
pub(crate) fn tukey_loss(residual: f64, sigma: f64) -> f64 {
    let share = tukey_share(residual, sigma);
    if share < 1.0 { 1.0 - (1.0 - share).powi(3) } else { 1.0 }
}

/// How much a residual counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Loss {
    /// Every residual by its square: the average relation, also where the model is but a rough one.
    LeastSquares,
    /// Tukey's biweight, c = 4.685 σ: residuals beyond c do not count at all. The relation of the majority.
    Tukey,
}

impl Loss {
    /// Weight of a residual of `scaled` = residual/σ, 0..=1. `starting` asks for the monotone weights.
    pub(crate) fn weight(self, scaled: f64, starting: bool) -> f64 {
        match self {
            Self::LeastSquares => 1.0,
            Self::Tukey if starting => (HUBER / scaled.abs().max(HUBER)).min(1.0),
            Self::Tukey => biweight((scaled / TUKEY_CUTOFF).powi(2)),
        }
    }

    /// Derivative of residual × weight by the residual.
    pub(crate) fn derivative(self, scaled: f64) -> f64 {
        match self {
            Self::LeastSquares => 1.0,
            Self::Tukey => {
                let share = (scaled / TUKEY_CUTOFF).powi(2);
                if share < 1.0 { (1.0 - share) * (1.0 - 5.0 * share) } else { 0.0 }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_derivative_is_that_of_residual_times_weight() {
        for scaled in [-6.0, -3.0, -0.5, 0.0, 0.2, 1.9, 4.0] {
            let psi = |u: f64| u * Loss::Tukey.weight(u, false);
            let numeric = (psi(scaled + 1e-6) - psi(scaled - 1e-6)) / 2e-6;
            // Central difference: h² ψ'''/6 plus rounding 1e-16/h.
            assert!((numeric - Loss::Tukey.derivative(scaled)).abs() < 1e-8, "{scaled}");
        }
    }

    #[test]
    fn the_biweight_is_the_slope_of_the_loss() {
        for residual in [-6.0, -2.0, 0.0, 0.3, 1.4, 4.0f64] {
            let slope = (tukey_loss(residual + 1e-6, 0.5) - tukey_loss(residual - 1e-6, 0.5)) / 2e-6;
            // d/dr of 1 − (1 − r²/c²)³ is 6 r/c² of the biweight; central difference as above.
            let factor = 6.0 * residual / (TUKEY_CUTOFF * 0.5).powi(2);
            assert!((slope - factor * biweight(tukey_share(residual, 0.5))).abs() < 1e-8, "{residual}");
        }
        assert_eq!(biweight(f64::NAN), 0.0);
    }
}
