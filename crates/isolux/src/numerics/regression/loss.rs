//! Weights of residuals.

/// Huber's tuning constant: 95 % efficiency at normal errors.
const HUBER: f64 = 1.345;
/// Tukey's: the same efficiency (methods, section 4).
const TUKEY: f64 = 4.685;

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
            Self::Tukey => {
                let share = (scaled / TUKEY).powi(2);
                if share < 1.0 { (1.0 - share).powi(2) } else { 0.0 }
            }
        }
    }

    /// Derivative of residual × weight by the residual.
    pub(super) fn derivative(self, scaled: f64) -> f64 {
        match self {
            Self::LeastSquares => 1.0,
            Self::Tukey => {
                let share = (scaled / TUKEY).powi(2);
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
}
