//! Remarks of the pipeline for the user, as data.

use std::fmt;

use isolux::Advice;
use isolux::calibrate::AmbientUnknown;
use isolux::inspect::Suspicion;
use isolux::standardize::Note;
use isolux_io::recording::UnusedLens;

/// How much a remark matters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Severity {
    /// Good to know.
    Note,
    /// It may spoil the result.
    Warning,
}

/// Something that the user should know and that is in no result. [`Display`](fmt::Display) says what was found;
/// [`Remark::advice`] says what the user can do about it.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Remark {
    /// A note of the plan of a chain.
    Plan(Note),
    /// A recording is probably not what it says.
    Suspicion {
        /// The recording.
        recording: String,
        /// What contradicts it.
        suspicion: Suspicion,
    },
    /// Fields about the lens of a recording are not used.
    LensUnused {
        /// The recording.
        recording: String,
        /// The fields, and why.
        unused: UnusedLens,
    },
    /// Pixels that the lens of a recording gives no ray.
    PixelsWithoutRay {
        /// The recording.
        recording: String,
        /// Their number.
        pixels: usize,
        /// Number of all pixels.
        of: usize,
    },
    /// The noise of the amplitude had to be taken from neighbouring pixels.
    NoiseFromNeighbours {
        /// The recording.
        recording: String,
    },
    /// The ambient light of a recording is not known.
    AmbientLightUnknown {
        /// The recording.
        recording: String,
        /// Why.
        cause: AmbientUnknown,
    },
    /// The scene of an evaluation did not stand still.
    SceneMoved {
        /// Share of the scene that moved, 0 to 1.
        share: f64,
        /// Integration time at which it had moved, µs.
        integration_time_us: f64,
    },
    /// The recordings of one calibration name different cameras; the first is taken.
    CamerasDiffer {
        /// Their names.
        cameras: Vec<String>,
    },
    /// The recordings of one calibration name different modulation frequencies, or some of them none.
    FrequenciesDiffer,
}

impl Remark {
    /// How much it matters.
    #[must_use]
    pub fn severity(&self) -> Severity {
        match self {
            Self::Plan(note) if note.is_warning() => Severity::Warning,
            Self::Plan(_)
            | Self::PixelsWithoutRay { .. }
            | Self::NoiseFromNeighbours { .. }
            | Self::AmbientLightUnknown { .. } => Severity::Note,
            Self::Suspicion { .. }
            | Self::LensUnused { .. }
            | Self::SceneMoved { .. }
            | Self::CamerasDiffer { .. }
            | Self::FrequenciesDiffer => Severity::Warning,
        }
    }

    /// What can be done about it.
    #[must_use]
    pub fn advice(&self) -> Option<Advice> {
        match self {
            Self::CamerasDiffer { .. } => Some(Advice::NameCamera),
            Self::Plan(note) => note.advice(),
            Self::Suspicion { suspicion, .. } => suspicion.advice(),
            _ => None,
        }
    }
}

impl fmt::Display for Remark {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Plan(note) => note.fmt(f),
            Self::Suspicion { recording, suspicion } => write!(f, "`{recording}`: {suspicion}"),
            Self::LensUnused { recording, unused } => write!(
                f,
                "`{recording}`: {unused}; without them, distances and angles are wrong towards the edges of the image"
            ),
            Self::PixelsWithoutRay { recording, pixels, of } => write!(
                f,
                "`{recording}`: {pixels} of {of} pixels have no ray in its lens: no angle, and no distance from a depth"
            ),
            Self::NoiseFromNeighbours { recording } => write!(
                f,
                "`{recording}`: no two consecutive frames share an integration time: the noise is taken from \
                 neighbouring pixels, texture included"
            ),
            Self::AmbientLightUnknown { recording, cause } => {
                write!(f, "`{recording}`: its ambient light is not known: {cause}")
            }
            Self::SceneMoved { share, integration_time_us } => write!(
                f,
                "the scene did not stand still ({:.0} % of it has moved at {integration_time_us} µs): figures over \
                 integration times also show its movement",
                100.0 * share
            ),
            Self::CamerasDiffer { cameras } => {
                write!(f, "the recordings name different cameras (`{}`)", cameras.join("`, `"))
            }
            Self::FrequenciesDiffer => f.write_str(
                "the recordings name different modulation frequencies, or some of them none: the spline goes without \
                 the harmonic, and the response repairs no distance",
            ),
        }
    }
}
