//! What a user can do about an error or a warning, as data. Whoever shows it words it: the command line as options,
//! Python as arguments.

use crate::choice::{DistanceStep, TimeStep};

/// The kinds of recordings that a calibration is fitted from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RecordingKind {
    /// A still scene while the integration time is varied.
    ExposureSweep,
    /// A flat target at several distances.
    DistanceSweep,
    /// Labelled materials in any pose.
    Target,
    /// Ordinary recordings without a rig.
    Scene,
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
    /// Tell the noise of the amplitude.
    GiveNoise,
    /// Tell the noise of the amplitude, or let it be estimated from the recording.
    GiveOrEstimateNoise,
    /// Tell the number of frames of a bracket.
    GiveBracketLength,
    /// Name the camera.
    NameCamera,
    /// Do not keep the channels of the input.
    LeaveInputOut,
    /// Record within the calibrated range of integration times, calibrate further, or take the time out by physics.
    RecordCalibratedTimes,
    /// Tell the intrinsics of the recording.
    GiveIntrinsics,
    /// Tell the modulation frequency.
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
}
