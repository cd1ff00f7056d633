//! Exposure sweeps: recordings of a still scene at several integration times, to which the table over integration
//! time, the response of the pixels and the noise are fitted.

mod evidence;
mod fit;
mod floor;
mod mean_curve;
mod noise_survey;
mod sweep;
mod tiers;
mod warning;

pub use evidence::ResponseEvidence;
pub(super) use fit::{TableError, fit};
pub(super) use noise_survey::counted_amplitudes;
pub use noise_survey::{NoiseCells, NoiseSurvey};
pub use sweep::{ExposureCurve, ExposureSweep};
pub(super) use tiers::fit_response;
pub use warning::{ExposureWarning, MissingTier};
