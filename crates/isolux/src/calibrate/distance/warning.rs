//! Warnings about distance sweeps and the laws that are fitted to them.

use std::fmt;

use crate::advice::{Advice, RecordingField};
use crate::calibrate::severity::Severity;
use crate::calibrate::sweep_fault::SweepFault;
use crate::terms::response::AmbientError;
use crate::terms::spline::SplineError;

/// A warning about a distance sweep, with its numbers.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum DistanceWarning {
    /// A fault of the recording.
    Fault(SweepFault),
    /// Distances that were recorded at unknown integration times.
    TimesUnknown {
        /// The recording.
        recording: String,
    },
    /// Frames whose window is saturated or empty.
    SaturationInWindow {
        /// The recording.
        recording: String,
        /// Frames left out for it.
        frames: usize,
    },
    /// Frames whose distances scatter too much.
    UnreliableDistances {
        /// The recording.
        recording: String,
        /// Frames left out for it.
        frames: usize,
    },
    /// A decay left out because few of its frames have a reliable distance.
    FewReliable {
        /// The recording.
        recording: String,
        /// Integration time, µs.
        integration_time_us: Option<f64>,
        /// Frames with a reliable distance.
        reliable: usize,
        /// All its frames.
        frames: usize,
    },
    /// Near positions where the amplitude falls towards the camera: over-saturation.
    OverSaturated {
        /// The recording.
        recording: String,
        /// Integration time, µs.
        integration_time_us: Option<f64>,
        /// Positions left out.
        positions: usize,
        /// Usable from here on, m.
        from_m: f64,
    },
    /// A decay left out because its signal is too weak.
    LowSignal {
        /// The recording.
        recording: String,
        /// Integration time, µs.
        integration_time_us: Option<f64>,
        /// Median signal-to-noise ratio in the window.
        signal_to_noise: f64,
    },
    /// The target is tilted or not flat.
    TargetNotFronto {
        /// The recording.
        recording: String,
        /// Frame with the largest spread, from 0.
        frame: usize,
        /// Distance from one side of the window to the other, m.
        spread_m: f64,
    },
    /// The target moved while one position was recorded.
    TargetMoved {
        /// The recording.
        recording: String,
        /// First frame of the position, from 0.
        frame: usize,
        /// Range of the mean distances, m.
        range_m: f64,
    },
    /// A decay with few positions.
    TooFewDistances {
        /// Integration time, µs.
        integration_time_us: Option<f64>,
        /// Number found.
        found: usize,
    },
    /// A decay that could not be scaled onto the others.
    NoOverlap {
        /// Integration time, µs.
        integration_time_us: Option<f64>,
    },
    /// The spline could not be fitted; the cubic was.
    NoSpline {
        /// Why.
        reason: SplineError,
    },
    /// The response by amplitude and distance could not be fitted.
    NoAmbient {
        /// Why.
        reason: AmbientError,
    },
    /// A decay of which many positions contradict the others.
    Outliers {
        /// Integration time, µs.
        integration_time_us: Option<f64>,
        /// Positions without a weight in the spline.
        outliers: usize,
        /// All its positions.
        positions: usize,
    },
}

impl DistanceWarning {
    /// True when both say the same fault of the same recording, found on delivered and on linear amplitudes.
    pub(super) fn repeats(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Fault(one), Self::Fault(other)) => one.repeats(other),
            _ => self == other,
        }
    }

    /// How much it weighs.
    #[must_use]
    pub fn severity(&self) -> Severity {
        match self {
            Self::Fault(fault) => fault.severity(),
            Self::TimesUnknown { .. } => Severity::Poor,
            Self::TargetNotFronto { .. }
            | Self::TargetMoved { .. }
            | Self::TooFewDistances { .. }
            | Self::NoSpline { .. }
            | Self::Outliers { .. } => Severity::Doubt,
            _ => Severity::Note,
        }
    }

    /// What the user can do about it.
    #[must_use]
    pub fn advice(&self) -> Option<Advice> {
        match self {
            Self::Fault(fault) => fault.advice(),
            Self::TimesUnknown { .. } => Some(Advice::WriteField(RecordingField::IntegrationTime)),
            Self::TargetNotFronto { .. } => Some(Advice::Window),
            Self::NoSpline { reason } => reason.advice(),
            _ => None,
        }
    }
}

impl fmt::Display for DistanceWarning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Fault(fault) => fault.fmt(f),
            Self::TimesUnknown { recording } => write!(
                f,
                "{recording}: no law over distance can be told, the integration times are not recorded, and each distance was \
                 recorded in frames of its own: if the exposure was automatic, any law would fit; if it was constant, state it"
            ),
            Self::SaturationInWindow { recording, frames } => write!(
                f,
                "{recording}: {frames} frames left out, saturated or invalid in more than 5 % of the window: \
                 start farther away at long integration times"
            ),
            Self::UnreliableDistances { recording, frames } => write!(
                f,
                "{recording}: {frames} frames left out, the distances in the window scatter by more than 10 %: \
                 over-saturated, or too dark"
            ),
            Self::FewReliable { recording, integration_time_us, reliable, frames } => write!(
                f,
                "{recording}, {}: left out, only {reliable} of its {frames} frames have reliable distances",
                time(*integration_time_us)
            ),
            Self::OverSaturated { recording, integration_time_us, positions, from_m } => write!(
                f,
                "{recording}, {}: {positions} position(s) nearer than {from_m:.3} m left out as over-saturated",
                time(*integration_time_us)
            ),
            Self::LowSignal { recording, integration_time_us, signal_to_noise } => write!(
                f,
                "{recording}, {}: left out, the signal-to-noise ratio of {signal_to_noise:.1} is below 10 and its \
                 distances are not reliable",
                time(*integration_time_us)
            ),
            Self::TargetNotFronto { recording, frame, spread_m } => write!(
                f,
                "{recording}, frame {frame}: the distance changes by {:.0} mm across the window: turn the target \
                 to face the camera, or measure in a smaller window",
                1000.0 * spread_m
            ),
            Self::TargetMoved { recording, frame, range_m } => write!(
                f,
                "{recording}: from frame {frame} on, the target moves by {:.0} mm within one position: let it \
                 stand still",
                1000.0 * range_m
            ),
            Self::TooFewDistances { integration_time_us, found } => write!(
                f,
                "distance sweep, {}: {found} positions; record 8 or more",
                time(*integration_time_us)
            ),
            Self::NoOverlap { integration_time_us } => write!(
                f,
                "distance sweep, {}: left out, it neither reaches the reference distance nor overlaps the others",
                time(*integration_time_us)
            ),
            Self::NoSpline { reason } => write!(f, "distance sweep: no spline beside the cubic: {reason}"),
            Self::NoAmbient { reason } => {
                write!(f, "distance sweep: no response by amplitude and distance (`ambient`): {reason}")
            }
            Self::Outliers { integration_time_us, outliers, positions } => write!(
                f,
                "distance sweep, {}: {outliers} of {positions} positions contradict the other times and do not count \
                 in the spline: saturated, or another target",
                time(*integration_time_us)
            ),
        }
    }
}

fn time(integration_time_us: Option<f64>) -> String {
    integration_time_us.map_or_else(|| "time unknown".to_owned(), |time| format!("{time} µs"))
}
