//! Why no table could be fitted.

use crate::advice::Advice;

/// Why no table could be fitted.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LutError {
    /// Fewer than two usable integration times.
    #[error(
        "{found} usable integration times found, at least 2 expected: vary the integration time in the sweep"
    )]
    TooFewTimes {
        /// Number found.
        found: usize,
    },
    /// The reference time is not inside the usable range.
    #[error(
        "the reference time of {reference_us} µs is outside the usable sweep of {min_us} to {max_us} µs: \
         record further, or choose another"
    )]
    ReferenceOutside {
        /// Reference asked for, µs.
        reference_us: f64,
        /// Lowest usable time, µs.
        min_us: f64,
        /// Time of the peak, µs.
        max_us: f64,
    },
    /// A mean amplitude is zero or not finite.
    #[error(
        "the mean amplitude at {integration_time_us} µs is {mean_amplitude}: no valid pixel there; leave this time out"
    )]
    NoSignal {
        /// Time, µs.
        integration_time_us: f64,
        /// Mean found, in the unit of the samples.
        mean_amplitude: f64,
    },
}

impl LutError {
    /// What the user can do about it.
    #[must_use]
    pub fn advice(&self) -> Option<Advice> {
        match *self {
            Self::TooFewTimes { .. } => None,
            Self::ReferenceOutside { reference_us, min_us, max_us } => {
                let nearest_us = if reference_us < min_us { min_us } else { max_us };
                Some(Advice::ReferenceTime { integration_time_us: Some(nearest_us) })
            }
            Self::NoSignal { integration_time_us, .. } => Some(Advice::ExcludeTime { integration_time_us }),
        }
    }
}
