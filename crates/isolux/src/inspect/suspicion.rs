//! What contradicts a recording's claims, and the sentences.

use std::fmt;

use serde::Serialize;

use super::phase::PhaseFault;
use crate::advice::{Advice, RecordingField};

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
    /// Phase samples that are read in the wrong order or with the wrong sign.
    PhaseConvention(PhaseFault),
    /// Many phase samples share the largest value: they clip at a value that the recording does not name.
    PhaseSamplesClip {
        /// The value, DN.
        value_dn: f32,
        /// Share of the phase samples that have it, or its negative, 0..=1.
        share: f64,
        /// True where they clip at the negative value too.
        both_signs: bool,
    },
}

impl Suspicion {
    /// A few words for a headline.
    #[must_use]
    pub fn short(&self) -> &'static str {
        match self {
            Self::AmplitudeCode { .. } => "a code that is not named",
            Self::PhaseConvention(_) => "phases in another order or sign",
            Self::PhaseSamplesClip { .. } => "phase samples that clip",
        }
    }

    /// What can be done about it.
    #[must_use]
    pub fn advice(&self) -> Option<Advice> {
        match self {
            Self::AmplitudeCode { value_dn, .. } => {
                Some(Advice::WriteField(RecordingField::SaturatedAmplitude { value_dn: *value_dn }))
            }
            Self::PhaseConvention(fault) => {
                Some(Advice::WriteField(RecordingField::PhaseConvention(fault.fitting)))
            }
            Self::PhaseSamplesClip { value_dn, .. } => {
                Some(Advice::WriteField(RecordingField::SaturatedPhaseSample { value_dn: *value_dn }))
            }
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
            Self::PhaseConvention(fault) => fault.fmt(f),
            Self::PhaseSamplesClip { value_dn, share, both_signs } => write!(
                f,
                "{:.2} % of the phase samples are exactly {}{value_dn}, and hardly any are near it: they clip there, and \
                 the amplitudes of these pixels are wrong",
                100.0 * share,
                if *both_signs { "±" } else { "" }
            ),
        }
    }
}
