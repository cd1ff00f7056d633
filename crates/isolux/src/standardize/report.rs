//! What a plan has to say: the steps, what the user should know of them, and why a choice cannot be carried out.

use std::fmt;

use crate::frame::Shape;

/// One step of the chain, as the output's record tells it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AppliedStep {
    /// Which effect it takes out: `time`, `denoise`, `distance`, `profile`, `angle` or `specular`; `sigma` predicts what
    /// is left.
    pub effect: &'static str,
    /// Name of the term.
    pub term: &'static str,
    /// Its parameters, in words.
    pub parameters: String,
}

/// Something that the user should know of the plan.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Note {
    /// No calibration: textbook physics, not this camera.
    Textbook {
        /// The terms that are used.
        terms: String,
    },
    /// `best` goes without a term that the calibration lacks.
    TermMissing {
        /// The term.
        term: &'static str,
        /// What can be done about it.
        instead: &'static str,
    },
    /// A step is left out because the recording lacks its channel.
    ChannelMissing {
        /// The effect that stays in.
        effect: &'static str,
        /// The channel.
        channel: &'static str,
    },
    /// The distance is to be denoised, but no step scales by it.
    NothingToDenoise,
    /// The noise of the distance cannot be computed from that of the amplitude.
    FrequencyUnknown,
    /// `best` goes without the profile, which holds for another image format.
    ProfileFormat {
        /// Shape of the recording's frames.
        found: Shape,
        /// Shape that the profile was fitted on.
        expected: Shape,
    },
    /// The calibration knows no angle, so that Lambert's cosine stands in.
    Lambert,
}

impl fmt::Display for Note {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Textbook { terms } => write!(
                f,
                "no calibration given: {terms} is textbook physics, not this camera. `isolux calibrate` measures its \
                 saturation and its own distance law"
            ),
            Self::TermMissing { term, instead } => {
                write!(f, "the calibration has no `{term}`: this step is left out. {instead}")
            }
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
            Self::Lambert => f.write_str(
                "the calibration has no `angle`: Lambert's cosine is textbook physics, not this camera's targets. `isolux \
                 calibrate --target REC` measures it",
            ),
        }
    }
}

/// Why a choice cannot be carried out.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum PlanError {
    /// A term asked for by name is not there.
    #[error(
        "`{term}` was asked for, but {holder}: fit it with `isolux calibrate {fit_with} REC`, or choose another step"
    )]
    TermMissing {
        /// The term.
        term: &'static str,
        /// Who lacks it.
        holder: &'static str,
        /// Option of `isolux calibrate` that fits it.
        fit_with: &'static str,
    },
    /// A step asked for by name needs a channel that the recording lacks.
    #[error("`{term}` was asked for, but the recording has no {channel}")]
    ChannelMissing {
        /// The term.
        term: &'static str,
        /// The channel.
        channel: &'static str,
    },
    /// A prediction of the standard deviation without the noise of the amplitude.
    #[error(
        "`sigma` was asked for, but the noise of the amplitude is not known: give it (--read-noise-dn, \
         --shot-noise-dn2-per-dn), or fit it with `isolux calibrate --exposure-sweep REC`, several frames at each time"
    )]
    NoiseUnknown,
    /// The profile asked for is that of another image format.
    #[error(
        "`profile` was asked for, but it holds for images of {expected}, and the recording's are {found}"
    )]
    ProfileFormat {
        /// Shape of the recording's frames.
        found: Shape,
        /// Shape that the profile was fitted on.
        expected: Shape,
    },
    /// No rays, no angles.
    #[error(
        "`angle` was asked for, but the recording has no intrinsics: write {{\"intrinsics\": {{\"fx\": .., \"fy\": .., \
         \"cx\": .., \"cy\": ..}}}} (pixels) into its recording.json"
    )]
    IntrinsicsMissing,
    /// The calibration's own values are impossible.
    #[error("calibration: {0}")]
    Calibration(#[from] crate::terms::ParameterError),
}
