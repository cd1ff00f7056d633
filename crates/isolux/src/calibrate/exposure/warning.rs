//! Warnings about exposure sweeps, and the table and the response that are fitted to them.

use std::fmt;

use crate::advice::Advice;
use crate::calibrate::severity::Severity;
use crate::calibrate::sweep_fault::SweepFault;
use crate::terms::response::ResponseError;

/// A warning about an exposure sweep, with its numbers.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum ExposureWarning {
    /// A fault of the recording.
    Fault(SweepFault),
    /// The integration times of a sweep do not increase.
    TimesNotIncreasing {
        /// The recording.
        recording: String,
    },
    /// Amplitudes drift after each change of the integration time.
    Settling {
        /// The recording.
        recording: String,
        /// Relative difference of the first frame of a run from the last, median over the runs.
        relative_drift: f64,
    },
    /// The scene did not stand still.
    SceneMoved {
        /// The recording.
        recording: String,
        /// Time at which the scene had moved, µs.
        integration_time_us: f64,
        /// Share of the image that moved.
        share: f64,
    },
    /// No integration time was recorded twice: nothing shows a frame that is wrong, or a drift.
    NoRepeats {
        /// The recording.
        recording: String,
    },
    /// An integration time that was left out, because a frame has no pixel with a value.
    NoMeasurement {
        /// The recording.
        recording: String,
        /// The time, µs.
        integration_time_us: f64,
    },
    /// Few integration times.
    TooFewTimes {
        /// The recording.
        recording: String,
        /// Number found.
        found: usize,
    },
    /// Pixels with the saturation code inside the range of the table.
    Saturation {
        /// The recording.
        recording: String,
        /// From this time on, µs.
        from_us: f64,
        /// Largest share of the pixels.
        share: f64,
    },
    /// A tier of the response that could not be fitted.
    NoTier(MissingTier),
}

impl ExposureWarning {
    /// How much it weighs.
    #[must_use]
    pub fn severity(&self) -> Severity {
        match self {
            Self::Fault(fault) => fault.severity(),
            Self::SceneMoved { .. } => Severity::Poor,
            Self::NoMeasurement { .. } | Self::NoTier(_) => Severity::Note,
            _ => Severity::Doubt,
        }
    }

    /// What the user can do about it.
    #[must_use]
    pub fn advice(&self) -> Option<Advice> {
        match self {
            Self::Fault(fault) => fault.advice(),
            Self::Settling { .. } => Some(Advice::SkipFrames),
            _ => None,
        }
    }
}

impl fmt::Display for ExposureWarning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Fault(fault) => fault.fmt(f),
            Self::TimesNotIncreasing { recording } => write!(
                f,
                "{recording}: the integration times do not increase throughout; a warm camera then meets other \
                 conditions than a cold one: sweep upwards, and skip the settling frames"
            ),
            Self::Settling { recording, relative_drift } => write!(
                f,
                "{recording}: after a change of the integration time, the first frames differ from the last by \
                 {:.1} %",
                100.0 * relative_drift
            ),
            Self::SceneMoved { recording, integration_time_us, share } => write!(
                f,
                "{recording}: at {integration_time_us} µs, {:.0} % of the image is at another distance than \
                 usual: an exposure sweep needs a still scene",
                100.0 * share
            ),
            Self::NoRepeats { recording } => write!(
                f,
                "{recording}: each integration time was recorded once, so that a wrong frame or a drifting gain would not \
                 be noticed: record several frames at each"
            ),
            Self::NoMeasurement { recording, integration_time_us } => write!(
                f,
                "{recording}: {integration_time_us} µs left out, a frame there has no valid pixel (dark, or all \
                 saturated)"
            ),
            Self::TooFewTimes { recording, found } => write!(
                f,
                "{recording}: {found} usable integration times; record 8 or more, evenly spread in ln t"
            ),
            Self::Saturation { recording, from_us, share } => write!(
                f,
                "{recording}: from {from_us} µs on, up to {:.1} % of the pixels carry the saturation code and \
                 drop out of the mean: use a darker or more distant wall",
                100.0 * share
            ),
            Self::NoTier(missing) => missing.fmt(f),
        }
    }
}

/// A tier of the response that the recordings do not determine although they have its channels.
#[derive(Clone, Debug, PartialEq)]
pub struct MissingTier {
    /// The tier.
    pub tier: &'static str,
    /// Why.
    pub reason: ResponseError,
}

impl fmt::Display for MissingTier {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "no response by `{}`: {}", self.tier, self.reason)
    }
}
