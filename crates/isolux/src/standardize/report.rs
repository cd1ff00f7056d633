//! What a plan reports: its steps, notes for the user, and why a choice cannot be carried out.

use std::fmt;

use crate::advice::{Advice, RecordingKind};
use crate::frame::{LensError, Shape};
use crate::step_names::{DistanceStep, TimeStep};

/// One step of the chain, as it is recorded with the output.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AppliedStep {
    /// The effect that the step removes: `time`, `denoise`, `distance`, `profile`, `angle` or `specular`; `sigma`
    /// for the prediction of the noise that is left.
    pub effect: &'static str,
    /// Name of the term.
    pub term: &'static str,
    /// Its parameters, in words.
    pub parameters: String,
}

/// Something that the user should know about the plan.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Note {
    /// There is no calibration: the steps are textbook physics, not measured on this camera.
    Textbook {
        /// The terms that are used.
        terms: String,
    },
    /// Nothing tells `best` how full the pixels are: it does not correct for saturation.
    FillUnknown,
    /// `best` leaves out the step for the integration time, because the calibration has no term for it.
    NoTimeTerm,
    /// `best` leaves out the step for the distance, because the calibration has no term for it.
    NoDistanceTerm,
    /// A step is left out because the recording lacks its channel.
    ChannelMissing {
        /// The effect that is not removed.
        effect: &'static str,
        /// The channel.
        channel: &'static str,
    },
    /// The distance is to be denoised, but no step scales by it.
    NothingToDenoise,
    /// The modulation frequency is unknown, so that the noise of the distance is estimated from each frame.
    FrequencyUnknown,
    /// `best` leaves out the profile, which was fitted on frames of another shape.
    ProfileFormat {
        /// Shape of the recording's frames.
        found: Shape,
        /// Shape that the profile was fitted on.
        expected: Shape,
    },
    /// The frames are scaled relative to each other, by what stands still.
    Relative {
        /// Frames that could be compared.
        compared: usize,
        /// Frames in which nothing stands still: they get no values.
        without: usize,
    },
    /// The calibration has no angle term; Lambert's cosine is used.
    Lambert,
    /// `best` leaves out a step, because the amplitudes of the recording no longer show the effect.
    AlreadyCorrected {
        /// The effect.
        effect: &'static str,
    },
    /// The calibration is that of another camera.
    OtherCamera {
        /// The camera that was calibrated.
        calibrated: String,
        /// The recording's camera.
        recorded: String,
    },
    /// The calibration is for another modulation frequency.
    OtherFrequency {
        /// The frequency that was calibrated, Hz.
        calibrated_hz: f64,
        /// The recording's frequency, Hz.
        recorded_hz: f64,
    },
}

impl Note {
    /// True where the result may be wrong; else it is good to know.
    #[must_use]
    pub fn is_warning(&self) -> bool {
        matches!(self, Self::OtherCamera { .. } | Self::OtherFrequency { .. })
    }

    /// What the user can do about it.
    #[must_use]
    pub fn advice(&self) -> Option<Advice> {
        match self {
            Self::Textbook { .. } => Some(Advice::Calibrate),
            Self::NoTimeTerm => Some(Advice::UseTimeStep(TimeStep::Linear)),
            Self::NoDistanceTerm => Some(Advice::UseDistanceStep(DistanceStep::Square)),
            Self::Lambert => Some(Advice::CalibrateFrom(RecordingKind::Target)),
            Self::FrequencyUnknown => Some(Advice::GiveModulationFrequency),
            Self::ChannelMissing { .. }
            | Self::FillUnknown
            | Self::NothingToDenoise
            | Self::AlreadyCorrected { .. }
            | Self::Relative { .. }
            | Self::ProfileFormat { .. } => None,
            Self::OtherCamera { .. } | Self::OtherFrequency { .. } => Some(Advice::Calibrate),
        }
    }
}

impl fmt::Display for Note {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Textbook { terms } => write!(
                f,
                "no calibration given: {terms} is textbook physics, not this camera. A calibration holds its \
                 saturation and its own distance law"
            ),
            Self::FillUnknown => f.write_str(
                "how full the pixels are is not known: amplitudes are scaled by the integration time, and not corrected \
                 for saturation",
            ),
            Self::NoTimeTerm => f.write_str("the calibration has no `lut`: this step is left out"),
            Self::NoDistanceTerm => f.write_str("the calibration has neither `spline` nor `cubic`: this step is left out"),
            Self::ChannelMissing { effect, channel } => {
                write!(f, "the recording has no {channel}: the {effect} step is left out")
            }
            Self::FrequencyUnknown => f.write_str(
                "the recording does not name its modulation frequency: sigma takes the noise of the distance from \
                 each frame's own scatter",
            ),
            Self::NothingToDenoise => f.write_str(
                "no step scales by the distance: there is nothing to denoise, and this step is left out",
            ),
            Self::ProfileFormat { found, expected } => write!(
                f,
                "the frames are {found}, the calibration's `profile` is for {expected}: this step is left out"
            ),
            Self::Relative { compared, without } => {
                write!(
                    f,
                    "the {compared} frames are comparable with each other, by what stands still in them; their level is \
                     relative, not that of any integration time"
                )?;
                if *without > 0 { write!(f, ". {without} frames in which nothing stands still get no values") } else { Ok(()) }
            }
            Self::Lambert => f.write_str(
                "the calibration has no `angle`: Lambert's cosine is textbook physics, not this camera's targets",
            ),
            Self::AlreadyCorrected { effect } => {
                write!(f, "the amplitudes no longer depend on the {effect}: this step is left out")
            }
            Self::OtherCamera { calibrated, recorded } => write!(
                f,
                "the calibration is that of `{calibrated}`, the recording is from `{recorded}`: saturation, distance law \
                 and profile differ from camera to camera"
            ),
            Self::OtherFrequency { calibrated_hz, recorded_hz } => write!(
                f,
                "the calibration is for a modulation frequency of {} MHz, the recording has {} MHz: distances and their \
                 law differ",
                calibrated_hz / 1e6,
                recorded_hz / 1e6
            ),
        }
    }
}

/// Why a choice cannot be carried out.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PlanError {
    /// A term asked for by name is not in the calibration.
    #[error("`{term}` was asked for, but the calibration does not hold it")]
    TermMissing {
        /// The term.
        term: &'static str,
        /// The kind of recording that it is fitted from.
        fit_from: RecordingKind,
    },
    /// A term asked for by name needs a calibration.
    #[error("`{term}` was asked for, but no calibration is given")]
    CalibrationMissing {
        /// The term.
        term: &'static str,
        /// The kind of recording that it is fitted from.
        fit_from: RecordingKind,
    },
    /// A step asked for by name needs a channel that the recording lacks.
    #[error("`{term}` was asked for, but the recording has no {channel}")]
    ChannelMissing {
        /// The term.
        term: &'static str,
        /// The channel.
        channel: &'static str,
    },
    /// The step `relative` was asked for, but the frames cannot be compared.
    #[error(
        "`relative` was asked for, but the frames cannot be compared: in most of them, too little stands still, or they can \
         be read only once"
    )]
    NothingStandsStill,
    /// The response by amplitude and distance was asked for, but the ambient light is unknown.
    #[error("tier `ambient` was asked for, but the ambient light of the recording is not known")]
    AmbientLightUnknown,
    /// The standard deviation was asked for, but the noise of the amplitude is unknown.
    #[error("`sigma` was asked for, but the noise of the amplitude is not known")]
    NoiseUnknown,
    /// The profile was asked for, but it was fitted on frames of another shape.
    #[error(
        "`profile` was asked for, but it holds for images of {expected}, and the recording's are {found}"
    )]
    ProfileFormat {
        /// Shape of the recording's frames.
        found: Shape,
        /// Shape that the profile was fitted on.
        expected: Shape,
    },
    /// The angle was asked for, but the recording has no intrinsics, from which the rays are computed.
    #[error("`angle` was asked for, but the recording has no intrinsics and no rays")]
    IntrinsicsMissing,
    /// The angle was asked for with a lens whose rays depend on the shape of the frames, which was not given.
    #[error(
        "`angle` was asked for, but the shape of the frames, which the rays of their lens depend on, is unknown"
    )]
    LensWithoutShape,
    /// The lens does not fit the frames.
    #[error("`angle` was asked for, but the lens does not fit the frames: {0}")]
    Lens(#[from] LensError),
    /// The calibration's own values are impossible.
    #[error("calibration: {0}")]
    Calibration(#[from] crate::terms::ParameterError),
}

impl PlanError {
    /// What the user can do about it.
    #[must_use]
    pub fn advice(&self) -> Option<Advice> {
        match self {
            Self::TermMissing { fit_from, .. } | Self::CalibrationMissing { fit_from, .. } => {
                Some(Advice::CalibrateFrom(*fit_from))
            }
            Self::NoiseUnknown => Some(Advice::GiveNoise),
            Self::IntrinsicsMissing | Self::Lens(_) => Some(Advice::GiveIntrinsics),
            Self::AmbientLightUnknown
            | Self::NothingStandsStill
            | Self::ChannelMissing { .. }
            | Self::ProfileFormat { .. }
            | Self::LensWithoutShape
            | Self::Calibration(_) => None,
        }
    }
}
