//! What observations know of each factor of the joint model.

use super::factor::Factor;
use super::refusal::{LARGEST_ERROR, Refusal};

/// What the observations know of one factor.
#[derive(Clone, Debug, PartialEq)]
pub struct Finding {
    /// Which factor.
    pub factor: Factor,
    /// Predicted standard error of its curve in ln, root mean square over its support. For k, of its effect at 60°.
    pub standard_error: f64,
    /// That error over the one it would have were the other factors known: 1 or more. Its condition.
    pub inflation: f64,
    /// Standard deviation, within surfaces, of ln d or ln cosθ that no other factor can take up; `None` for time and
    /// profile, whose abscissas have no errors.
    pub free_spread: Option<f64>,
    /// Why it is not given out; `None` where it is determined.
    pub refusal: Option<Refusal>,
}

impl Finding {
    /// Largest standard error of a curve that is given out.
    pub const LARGEST_ERROR: f64 = LARGEST_ERROR;
    /// Largest inflation.
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
            Self::Time | Self::Profile => None,
        }
    }
}
