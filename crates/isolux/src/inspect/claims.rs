//! What a recording says of itself.

use crate::frame::PhaseConvention;

/// What a recording says of itself, as far as its frames may contradict it. The default says nothing.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Claims {
    /// The modulation frequency, Hz.
    pub modulation_frequency_hz: Option<f64>,
    /// The range within which it tells distances apart, m.
    pub range_m: Option<f64>,
    /// True where the recording states the unit of the distances.
    pub distance_unit_stated: bool,
    /// Metres for one unit of the stored distances, as they are read.
    pub metres_per_unit: Option<f64>,
    /// Column and row of the principal point, pixels.
    pub principal_point: Option<[f64; 2]>,
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
