//! What can go wrong while a sweep is recorded, as far as the recording shows it.

use std::fmt;

use super::severity::{POOR_SHARE, Severity};
use crate::advice::Advice;

/// A fault in the recording of a sweep, with its numbers. Frames are counted from 0.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum SweepFault {
    /// Frames that differ from their repeats, or from the curve of all others: black ones, flashes. They are left out.
    StrayFrames {
        /// The recording.
        recording: String,
        /// Number of frames.
        frames: usize,
        /// The one that departs most.
        worst: usize,
        /// By how much its amplitude departs, relative: −1 for a black frame.
        departure: f64,
    },
    /// Parts of the image changed in some frames: a person walked through. They are left out there.
    PartsMoved {
        /// The recording.
        recording: String,
        /// Number of frames.
        frames: usize,
        /// Largest share of the image that changed in one of them, 0 to 1.
        share: f64,
    },
    /// The integration times belong to other frames.
    TimesLag {
        /// The recording.
        recording: String,
        /// By so many frames; negative where they run ahead.
        frames: isize,
    },
    /// The gain drifts in the course of the sweep.
    Drift {
        /// The recording.
        recording: String,
        /// Relative change.
        relative: f64,
    },
    /// Equal frames differ in such a way that the gain may drift, or may settle after each change; the recording does
    /// not tell which.
    DriftOrSettling {
        /// The recording.
        recording: String,
        /// Relative change, if it is a drift.
        relative: f64,
    },
    /// Amplitudes far below saturation do not grow with the integration time.
    NotInProportion {
        /// The recording.
        recording: String,
        /// Largest relative deviation.
        relative: f64,
    },
    /// The target became darker or brighter.
    TargetChanged {
        /// The recording.
        recording: String,
        /// From this frame on.
        frame: usize,
        /// Relative change.
        relative: f64,
    },
    /// Positions beyond the ambiguity range, which the camera takes for near ones.
    Wrapped {
        /// The recording.
        recording: String,
        /// First such frame.
        frame: usize,
        /// Its distance as delivered, m.
        distance_m: f64,
        /// Ambiguity range c / 2f, m, where the modulation frequency is known.
        range_m: Option<f64>,
    },
    /// Positions whose amplitude contradicts that of their neighbours: something else was in the window. They are left
    /// out.
    StrayPositions {
        /// The recording.
        recording: String,
        /// Number of positions.
        positions: usize,
        /// All positions.
        of: usize,
        /// A frame of the one that departs most.
        worst: usize,
        /// By how much its amplitude departs, relative.
        departure: f64,
    },
}

impl SweepFault {
    /// More positions than this share that contradict the others are no exception.
    const MANY_POSITIONS: f64 = 0.25;

    /// How much it weighs.
    #[must_use]
    pub fn severity(&self) -> Severity {
        let poor = match self {
            Self::TimesLag { .. } | Self::TargetChanged { .. } | Self::Wrapped { .. } => true,
            Self::Drift { relative, .. } | Self::NotInProportion { relative, .. } => {
                relative.abs() > POOR_SHARE
            }
            Self::StrayPositions { positions, of, .. } => {
                *positions as f64 > Self::MANY_POSITIONS * *of as f64
            }
            Self::StrayFrames { .. } | Self::PartsMoved { .. } | Self::DriftOrSettling { .. } => false,
        };
        if poor { Severity::Poor } else { Severity::Doubt }
    }

    /// What the user can do about it.
    #[must_use]
    pub fn advice(&self) -> Option<Advice> {
        match self {
            // The first frames of each time show the one before.
            Self::TimesLag { frames, .. } if *frames < 0 => Some(Advice::SkipFrames),
            Self::DriftOrSettling { .. } => Some(Advice::SkipFrames),
            _ => None,
        }
    }

    /// True when both are the same fault of the same recording, found twice.
    pub(super) fn repeats(&self, other: &Self) -> bool {
        std::mem::discriminant(self) == std::mem::discriminant(other) && self.recording() == other.recording()
    }

    fn recording(&self) -> &str {
        match self {
            Self::StrayFrames { recording, .. }
            | Self::PartsMoved { recording, .. }
            | Self::TimesLag { recording, .. }
            | Self::Drift { recording, .. }
            | Self::DriftOrSettling { recording, .. }
            | Self::NotInProportion { recording, .. }
            | Self::TargetChanged { recording, .. }
            | Self::Wrapped { recording, .. }
            | Self::StrayPositions { recording, .. } => recording,
        }
    }
}

fn percent(relative: &f64) -> f64 {
    100.0 * relative
}

impl fmt::Display for SweepFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: ", self.recording())?;
        match self {
            Self::StrayFrames { frames, worst, departure, .. } => write!(
                f,
                "{frames} frame(s) left out, which do not fit their repeats: frame {worst} departs by {:+.0} %",
                percent(departure)
            ),
            Self::PartsMoved { frames, share, .. } => write!(
                f,
                "something moved: in {frames} frame(s), up to {:.0} % of the image is left out",
                percent(share)
            ),
            Self::TimesLag { frames, .. } => write!(
                f,
                "the integration times {} the frames by {} frame(s): equal frames have unlike times",
                if *frames > 0 { "lag behind" } else { "run ahead of" },
                frames.abs()
            ),
            Self::Drift { relative, .. } => write!(
                f,
                "the gain drifts by {:+.1} % during the sweep: let the camera warm up, and keep its light and its \
                 temperature constant",
                percent(relative)
            ),
            Self::DriftOrSettling { relative, .. } => write!(
                f,
                "frames that should be equal differ: the camera settles after each change of the time, or its gain \
                 drifts by {:+.1} % during the sweep",
                percent(relative)
            ),
            Self::NotInProportion { relative, .. } => write!(
                f,
                "amplitudes far below saturation do not grow with the integration time, by {:+.1} %: the gain drifts, \
                 or the times are not those of the frames",
                percent(relative)
            ),
            Self::TargetChanged { frame, relative, .. } => write!(
                f,
                "from frame {frame} on, the target is {:.1} % {}: another board, another light, another gain, or \
                 distances beyond the ambiguity range",
                percent(&relative.abs()),
                if *relative < 0.0 { "darker" } else { "brighter" }
            ),
            Self::Wrapped { frame, distance_m, range_m, .. } => {
                write!(
                    f,
                    "from frame {frame} on, the distances are wrapped: {distance_m:.3} m, but far too dark for that; the \
                     target is beyond the ambiguity range"
                )?;
                range_m.map_or(Ok(()), |range_m| write!(f, " of {range_m:.3} m"))
            }
            Self::StrayPositions { positions, of, worst, departure, .. } => write!(
                f,
                "{positions} of {of} position(s) left out, which contradict their neighbours: frame {worst} departs by \
                 {:+.0} %: something else was in the window",
                percent(departure)
            ),
        }
    }
}
