//! How well the observations determine each factor of the joint model.

use super::factor::Factor;
use super::refusal::{LARGEST_ERROR, Refusal};

/// How well the observations determine one factor.
#[derive(Clone, Debug, PartialEq)]
pub struct Finding {
    /// Which factor.
    pub factor: Factor,
    /// Predicted standard error of its curve in ln, root mean square over its support. For k, of its effect at 60°.
    pub standard_error: f64,
    /// That error over the error it would have if the other factors were known: 1 or more.
    pub inflation: f64,
    /// Standard deviation, within surfaces, of that part of ln d or ln cosθ that no other factor explains; `None`
    /// for time and profile, whose abscissas have no errors.
    pub free_spread: Option<f64>,
    /// Why the factor is withheld; `None` where it is determined.
    pub refusal: Option<Refusal>,
}

impl Finding {
    /// Largest standard error of a curve that becomes a term.
    pub const LARGEST_ERROR: f64 = LARGEST_ERROR;
    /// Largest inflation of a factor that becomes a term.
    pub const LARGEST_INFLATION: f64 = 30.0;
    /// Least free standard deviation of ln d: ten times the errors of usual distances.
    pub const LEAST_SPREAD_LN_DISTANCE: f64 = 0.05;
    /// Least free standard deviation of ln cosθ: twice the errors of normals by plane fits.
    pub const LEAST_SPREAD_LN_COSINE: f64 = 0.03;
}

impl Factor {
    pub(super) fn least_spread(self) -> Option<f64> {
        match self {
            Self::Distance => Some(Finding::LEAST_SPREAD_LN_DISTANCE),
            Self::Angle => Some(Finding::LEAST_SPREAD_LN_COSINE),
            Self::Time | Self::Exposure | Self::Profile => None,
        }
    }
}
