//! What a recording says of itself.

/// What a recording says of itself, as far as its frames may contradict it. The default says nothing.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Claims {
    /// The modulation frequency, Hz.
    pub modulation_frequency_hz: Option<f64>,
    /// True where the recording states the unit of the distances.
    pub distance_unit_stated: bool,
    /// Metres for one unit of the stored distances, as they are read.
    pub metres_per_unit: Option<f64>,
    /// True where the amplitude is computed from the phase samples.
    pub amplitude_from_phase_samples: bool,
    /// Column and row of the principal point, pixels.
    pub principal_point: Option<[f64; 2]>,
    /// True where the recording says that its amplitudes have been standardized already.
    pub standardized: bool,
}
