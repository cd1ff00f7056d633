//! What contradicts a recording's claims, and the sentences.

use std::fmt;

use serde::Serialize;

use crate::advice::{Advice, RecordingField};
use crate::common_factor::{ExposureCourse, SpannedFrames};

/// Something about a recording that is probably not as it says. [`Display`](fmt::Display) says what was found;
/// [`Suspicion::advice`] what to do.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "suspicion", rename_all = "snake_case")]
#[non_exhaustive]
pub enum Suspicion {
    /// Many amplitudes share the largest value, far above all others: a code that the recording does not name.
    AmplitudeCode {
        /// The code, DN.
        value_dn: f32,
        /// Share of the pixels that have it, 0..=1.
        share: f64,
        /// Largest of the other amplitudes, DN.
        others_dn: f32,
    },
    /// Every frame spans exactly the same values: frames were scaled one by one.
    ScaledByFrame(SpannedFrames),
    /// All still pixels share a factor from frame to frame that no recorded time explains.
    ExposureChanged(ExposureCourse),
}

impl Suspicion {
    /// What can be done about it.
    #[must_use]
    pub fn advice(&self) -> Option<Advice> {
        match self {
            Self::AmplitudeCode { value_dn, .. } => {
                Some(Advice::WriteField(RecordingField::SaturatedAmplitude { value_dn: *value_dn }))
            }
            Self::ScaledByFrame(_) => Some(Advice::RecordUnscaledValues),
            Self::ExposureChanged(_) => Some(Advice::RecordTimes),
        }
    }
}

impl fmt::Display for Suspicion {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::AmplitudeCode { value_dn, share, others_dn } => write!(
                f,
                "{:.2} % of the amplitudes are exactly {value_dn}, the next largest is {others_dn}: probably a code \
                 for saturated pixels, taken for a measurement",
                100.0 * share
            ),
            Self::ScaledByFrame(spanned) => spanned.fmt(f),
            Self::ExposureChanged(course) => course.fmt(f),
        }
    }
}
