//! What a user can do about an error or a warning, as data. Each interface puts it into its own words: the command
//! line names options, Python names arguments.

use crate::frame::PhaseConvention;
use crate::step_names::{DistanceStep, TimeStep};

/// The kinds of recordings that a calibration is fitted from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RecordingKind {
    /// A still scene at several integration times.
    ExposureSweep,
    /// A flat target at several distances.
    DistanceSweep,
    /// Labelled materials in any pose.
    Target,
    /// Ordinary recordings, without a rig or labels.
    Scene,
}

/// A field of a recording's description, with the value that it seems to need.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum RecordingField {
    /// The amplitude that means saturated.
    SaturatedAmplitude {
        /// The code, DN.
        value_dn: f32,
    },
    /// A distance that is none.
    InvalidDistance {
        /// The code, as it is stored.
        value: f32,
    },
    /// The unit of the distances.
    DistanceUnit {
        /// Metres for one unit.
        metres: f64,
    },
    /// The integration times, which are to be in µs.
    TimesInMicroseconds {
        /// What they must be multiplied by.
        factor: f64,
    },
    /// The modulation frequency.
    ModulationFrequency,
    /// The intrinsics, of the resolution of the frames.
    Intrinsics,
    /// The value at which phase samples clip.
    SaturatedPhaseSample {
        /// The value, DN.
        value_dn: f32,
    },
    /// Order and sign of the phase samples.
    PhaseConvention(PhaseConvention),
    /// The integration time of all frames, where it was constant.
    IntegrationTime,
}

/// One thing to do.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Advice {
    /// Calibrate the camera.
    Calibrate,
    /// Calibrate from a recording of this kind.
    CalibrateFrom(RecordingKind),
    /// Take this step for the integration time instead.
    UseTimeStep(TimeStep),
    /// Take this step for the distance instead.
    UseDistanceStep(DistanceStep),
    /// State the noise of the amplitude.
    GiveNoise,
    /// State the noise of the amplitude, or let it be estimated from the recording.
    GiveOrEstimateNoise,
    /// State the number of frames of a bracket.
    GiveBracketLength,
    /// Name the camera.
    NameCamera,
    /// Do not keep the channels of the input.
    LeaveInputOut,
    /// Record within the calibrated range of integration times, calibrate a wider range, or scale by `t_ref / t`.
    RecordCalibratedTimes,
    /// State the intrinsics of the recording.
    GiveIntrinsics,
    /// State the modulation frequency.
    GiveModulationFrequency,
    /// Leave out the first frames after each change of the integration time.
    SkipFrames,
    /// Leave out an integration time.
    ExcludeTime {
        /// The time, µs.
        integration_time_us: f64,
    },
    /// Choose another reference time.
    ReferenceTime {
        /// One that the recordings cover, µs.
        integration_time_us: Option<f64>,
    },
    /// Choose another reference distance.
    ReferenceDistance {
        /// One that the recordings cover, m.
        distance_m: Option<f64>,
    },
    /// Choose another size of the window.
    Window,
    /// Take the calibration as it is, although it is poor.
    AcceptPoorFit,
    /// Record the values as the camera delivers them, before any stretching of single frames.
    RecordUnscaledValues,
    /// Record the integration time of each frame, fix the exposure, or take the factor that still pixels share out.
    RecordTimes,
    /// State this in the description of the recording.
    WriteField(RecordingField),
    /// Standardize the recording that this one was made from.
    TakeOriginal,
    /// Find out from all frames what the amplitudes depend on.
    Diagnose,
    /// Record with more light or longer integration times.
    RecordBrighter,
}
