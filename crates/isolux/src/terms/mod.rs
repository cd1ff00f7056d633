//! The correction terms. Each module holds the parameters of a term, the correction and the fit. A term has the
//! same name in code, in the calibration file and on the command line. Distances d are radial, in m; integration
//! times t in µs; amplitudes in DN. Multipliers are dimensionless; those over time and distance are 1 at the reference.
//!
//! | term | corrects | source |
//! |---|---|---|
//! | [`lut`] | integration time: a table | paper, section 2.1, eq. 4 |
//! | [`response`] | saturation, before `t_ref / t` | paper, eq. 3; methods, section 2 |
//! | [`linear`] | integration time: `t_ref / t` | paper, eq. 2 |
//! | [`cubic`] | distance: a polynomial | paper, section 2.2 |
//! | [`spline`] | distance: a smooth law around the inverse square | beyond the paper |
//! | [`square`] | distance: `(d / d_ref)²` | textbook |
//! | [`eq5`] | distance: `((2d)² + 1) / ((2 d_ref)² + 1)` | paper, eq. 5 |
//! | [`profile`] | illumination profile over the image | beyond the paper |
//! | [`angle`] | angle of incidence: `cos^−k θ` | beyond the paper; Lambert for k = 1 |
//! | [`noise`] | nothing; it predicts the variance of an amplitude | methods, section 1 |

pub mod angle;
pub mod cubic;
pub mod eq5;
pub mod linear;
pub mod lut;
pub mod noise;
pub mod profile;
pub mod response;
pub mod spline;
pub mod square;

pub(crate) mod check;
mod distance_law;
mod polynomial;
mod table;

pub use angle::Angle;
pub use check::ParameterError;
pub use cubic::Cubic;
pub use distance_law::DistanceLaw;
pub use lut::Lut;
pub use noise::{Noise, NoiseModel};
pub(crate) use polynomial::DistanceGain;
pub use profile::Profile;
pub use response::Response;
pub use spline::Spline;
pub(crate) use table::DistanceTable;

use serde::{Deserialize, Serialize};

/// A recording that a term was fitted on.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Source {
    /// Name of the recording, as the user gave it.
    pub recording: String,
    /// Frames that entered the fit.
    pub frames_used: usize,
    /// Frames left out: settling, excluded times, saturated windows.
    pub frames_left_out: usize,
}

/// How well a term fits its recordings.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FitQuality {
    /// Number of fitted points: integration times of a table, positions of a decay.
    pub points: usize,
    /// Root mean square of the relative error that the term leaves on these points, dimensionless.
    pub residual: f64,
    /// The same on points that were left out of the fit in turn; absent where there are too few points.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub held_out_residual: Option<f64>,
}

/// Multipliers that a fit may have. Beyond these limits, any amplitude would become 0 or infinite.
pub(crate) const MULTIPLIER_LIMITS: std::ops::RangeInclusive<f64> = 1e-12..=1e12;

/// Root mean square of `values`; `None` when there are none.
pub(crate) fn root_mean_square(values: impl IntoIterator<Item = f64>) -> Option<f64> {
    let (sum, count) = values.into_iter().fold((0.0, 0u32), |(sum, count), v| (sum + v * v, count + 1));
    (count > 0).then(|| (sum / f64::from(count)).sqrt())
}
