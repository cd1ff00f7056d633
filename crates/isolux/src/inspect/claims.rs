//! What a recording says of itself.

use crate::frame::PhaseConvention;

/// What a recording says of itself, as far as its frames may contradict it. The default says nothing.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Claims {
    /// The modulation frequency, Hz.
    pub modulation_frequency_hz: Option<f64>,
    /// True where the amplitudes are stored as whole numbers.
    pub amplitude_is_integer: bool,
    /// True where the distances are stored as whole numbers.
    pub distance_is_integer: bool,
    /// True where the recording states the unit of the distances.
    pub distance_unit_stated: bool,
    /// Metres for one unit of the stored distances.
    pub metres_per_unit: Option<f64>,
    /// True where the amplitude is computed from the phase samples.
    pub amplitude_from_phase_samples: bool,
    /// Order and sign by which the phase samples were read.
    pub phase_convention: PhaseConvention,
    /// True where the distance is computed from the phases.
    pub distance_from_phases: bool,
    /// The range within which distances are told apart, m, where the phases are not those of four bins: of I/Q, or of
    /// two frequencies together.
    pub unwrapped_range_m: Option<f64>,
    /// True where the recording says that its amplitudes have been standardized already.
    pub standardized: bool,
}
