//! The correction terms, one file or folder each: parameters, what they do, and how they are fitted. A term has one
//! name, in code and in the calibration file.

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

/// How well a term describes what it was fitted on.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FitQuality {
    /// Points that the fit rests on: integration times of a LUT, positions of a decay.
    pub points: usize,
    /// Root mean square of the relative error that the term leaves on these points, dimensionless.
    pub residual: f64,
    /// The same on points that were kept out of the fit in turn; absent where too few points are there.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub held_out_residual: Option<f64>,
}

/// Multipliers beyond these limits turn any amplitude into nothing or infinity; no fit gives them.
pub(crate) const MULTIPLIER_LIMITS: std::ops::RangeInclusive<f64> = 1e-12..=1e12;

/// Root mean square of `values`; `None` when there are none.
pub(crate) fn root_mean_square(values: impl IntoIterator<Item = f64>) -> Option<f64> {
    let (sum, count) = values.into_iter().fold((0.0, 0u32), |(sum, count), v| (sum + v * v, count + 1));
    (count > 0).then(|| (sum / f64::from(count)).sqrt())
}
