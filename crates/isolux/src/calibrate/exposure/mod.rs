//! Exposure sweeps: recordings of a still scene at several integration times, to which the table over integration
//! time, the response of the pixels and the noise are fitted.

mod evidence;
mod faults;
mod fit;
mod floor;
mod frame_sums;
mod mean_curve;
mod moved;
mod noise_survey;
mod proportion;
mod stray;
mod sweep;
mod tiers;
mod warning;

pub use evidence::ResponseEvidence;
pub(super) use fit::{TableError, fit};
pub use noise_survey::{NoiseCells, NoiseSurvey};
pub use sweep::{ExposureCurve, ExposureSweep};
pub(super) use tiers::fit_response;
pub use warning::{ExposureWarning, MissingTier};
