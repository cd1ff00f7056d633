//! The aliased third harmonic of the modulation.

use serde::{Deserialize, Serialize};

use crate::frame::phase;

/// The aliased third harmonic of the modulation, in ln h.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Harmonic {
    /// Modulation frequency f, Hz.
    pub modulation_frequency_hz: f64,
    /// Coefficient w_c of cos 4φ, dimensionless.
    pub cosine: f64,
    /// Coefficient w_s of sin 4φ, dimensionless.
    pub sine: f64,
}

impl Harmonic {
    /// 4φ at a distance (m), not wrapped, rad.
    pub(super) fn angle(modulation_frequency_hz: f64, distance_m: f64) -> f64 {
        4.0 * phase::of_distance(modulation_frequency_hz, distance_m)
    }

    /// `[cos 4φ, sin 4φ]`.
    pub(crate) fn columns(modulation_frequency_hz: f64, distance_m: f64) -> [f64; 2] {
        let (sine, cosine) = Self::angle(modulation_frequency_hz, distance_m).sin_cos();
        [cosine, sine]
    }

    /// Its part of ln h at a distance (m).
    pub(crate) fn at(&self, distance_m: f64) -> f64 {
        let [cosine, sine] = Self::columns(self.modulation_frequency_hz, distance_m);
        self.cosine * cosine + self.sine * sine
    }
}
