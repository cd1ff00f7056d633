//! What can go wrong between a recording and a result.

use isolux::calibrate::{CalibrateError, FitWarning, MeasureError, Verdict};
use isolux::standardize::{MergeError, PlanError, StandardizeError};
use isolux::{Advice, ShapeError};
use isolux_camera::CameraError;
use isolux_io::RecordingError;

/// Why a recording has no result. Messages say what was found, what was expected and why;
/// [`PipelineError::advice`] says what can be done about it.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PipelineError {
    /// The observer cancelled.
    #[error("interrupted; nothing was written")]
    Interrupted,
    /// A recording cannot be read or written.
    #[error(transparent)]
    Recording(#[from] RecordingError),
    /// A source or a sink that is not a recording failed.
    #[error("`{recording}`: {cause}")]
    Frames {
        /// Where they come from or go to.
        recording: String,
        /// Why.
        #[source]
        cause: Box<dyn std::error::Error + Send + Sync>,
    },
    /// The simulated camera.
    #[error(transparent)]
    Camera(#[from] CameraError),
    /// The chain cannot be planned.
    #[error(transparent)]
    Plan(#[from] PlanError),
    /// A frame cannot be worked on.
    #[error("`{recording}`, frame {frame}: {cause}")]
    Frame {
        /// The recording.
        recording: String,
        /// Index of the frame, from 0.
        frame: usize,
        /// Why.
        #[source]
        cause: FrameError,
    },
    /// A source has no frame of this index, although an earlier pass had.
    #[error("`{recording}`: no frame {frame} found, which one pass over it had")]
    FrameMissing {
        /// The source.
        recording: String,
        /// Index of the frame, from 0.
        frame: usize,
    },
    /// The standard deviation was asked for, but the noise of the amplitude is unknown and the recording does not
    /// show it.
    #[error(
        "`{recording}`: no noise found in groups of 16 like pixels or more, consecutive frames of a still scene at one \
         integration time expected"
    )]
    NoNoise {
        /// The recording.
        recording: String,
    },
    /// The noise cannot be told from the signal, because there is hardly any.
    #[error(
        "`{recording}`: too dark to tell the noise of the amplitude: no group of like pixels reaches a signal-to-noise ratio \
         of 3, the best has {signal_to_noise:.1}"
    )]
    TooDark {
        /// The recording.
        recording: String,
        /// The largest signal-to-noise ratio of the groups.
        signal_to_noise: f64,
    },
    /// Brackets should end where an integration time recurs, but a frame has no single integration time.
    #[error(
        "`{recording}`, frame {frame}: found no single integration time, one expected: a bracket ends where a time recurs"
    )]
    BracketTime {
        /// The recording.
        recording: String,
        /// Index of the frame, from 0.
        frame: usize,
    },
    /// The integration times show no bracket of two frames or more.
    #[error(
        "`{recording}`: every frame has the integration time of the frame before it, different times expected in a bracket"
    )]
    NoBrackets {
        /// The recording.
        recording: String,
    },
    /// The chain cannot merge brackets.
    #[error("brackets cannot be merged: {cause}")]
    Merge {
        /// Why.
        #[source]
        cause: MergeError,
    },
    /// A channel that is to be kept has the name of a new one.
    #[error("`{recording}` already has a channel `{channel}`, which cannot be kept beside the new one")]
    ChannelKept {
        /// The recording.
        recording: String,
        /// The channel.
        channel: String,
    },
    /// Input channels should be kept, but frames are merged.
    #[error(
        "found input channels to keep and frames to merge, one of the two expected: a merged frame has no input of its own"
    )]
    KeptOfMerged,
    /// The output needs the number of frames beforehand, and the source does not know it.
    #[error("`{recording}`: the number of frames is not known beforehand, which the output needs")]
    LengthUnknown {
        /// The source.
        recording: String,
    },
    /// Standardizing left no value at all, because of the integration times.
    #[error(
        "`{recording}`: every measured pixel's integration time is above the calibrated range or unknown, a time \
         inside it expected"
    )]
    TimesRefused {
        /// The recording.
        recording: String,
    },
    /// A recording cannot be measured for a calibration.
    #[error("`{recording}`: {cause}")]
    Measure {
        /// The recording.
        recording: String,
        /// Why.
        #[source]
        cause: MeasureError,
    },
    /// A calibration cannot be fitted to the measurements.
    #[error("{}", fit_text(distance_sweeps, cause))]
    Fit {
        /// Names of the distance sweeps, which are fitted together, so that the cause does not name a single one.
        distance_sweeps: Vec<String>,
        /// Why.
        #[source]
        cause: CalibrateError,
    },
    /// The fitted terms contradict their recordings.
    #[error("the calibration is {verdict}")]
    PoorFit {
        /// The verdict, which is poor, with its reasons.
        verdict: Verdict,
        /// Everything that the fits found.
        warnings: Vec<FitWarning>,
    },
    /// The operating system refused to start threads.
    #[error("cannot start threads: {0}")]
    Threads(#[from] rayon::ThreadPoolBuildError),
}

/// What is wrong with one frame.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FrameError {
    /// It cannot be standardized.
    #[error(transparent)]
    Standardize(#[from] StandardizeError),
    /// Its planes do not fit together.
    #[error(transparent)]
    Shape(#[from] ShapeError),
    /// It cannot be merged with others.
    #[error(transparent)]
    Merge(#[from] MergeError),
}

impl PipelineError {
    /// What the user can do about it.
    #[must_use]
    pub fn advice(&self) -> Option<Advice> {
        match self {
            Self::NoNoise { .. } | Self::TooDark { .. } => Some(Advice::GiveNoise),
            Self::BracketTime { .. } | Self::NoBrackets { .. } => Some(Advice::GiveBracketLength),
            Self::Merge { .. } => Some(Advice::GiveOrEstimateNoise),
            Self::ChannelKept { .. } => Some(Advice::LeaveInputOut),
            Self::TimesRefused { .. } => Some(Advice::RecordCalibratedTimes),
            Self::Plan(cause) => cause.advice(),
            Self::Frame { cause: FrameError::Standardize(cause), .. } => cause.advice(),
            Self::Measure { cause, .. } => cause.advice(),
            Self::Fit { cause, .. } => cause.advice(),
            Self::PoorFit { .. } => Some(Advice::AcceptPoorFit),
            _ => None,
        }
    }

    /// What was left out before a fit failed, and why; this is often the reason.
    #[must_use]
    pub fn warnings(&self) -> &[FitWarning] {
        match self {
            Self::Fit { cause, .. } => cause.warnings(),
            Self::PoorFit { warnings, .. } => warnings,
            _ => &[],
        }
    }

    /// Adds the recording and the frame to a cause.
    pub(crate) fn frame(recording: &str, frame: usize) -> impl Fn(FrameError) -> Self {
        move |cause| Self::Frame { recording: recording.to_owned(), frame, cause }
    }
}

fn fit_text(distance_sweeps: &[String], cause: &CalibrateError) -> String {
    match cause {
        CalibrateError::Cubic { source, .. } => {
            format!("distance sweep `{}`: {source}", distance_sweeps.join("`, `"))
        }
        other => other.to_string(),
    }
}
