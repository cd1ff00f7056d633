//! The four bins of a cosine, in the paper's order.

use std::f64::consts::FRAC_PI_2;

/// `A_k = mean + amplitude cos(phase − kπ/2)`, all in one unit, the phase in rad (methods, section 1).
pub(super) fn bins(mean: f64, amplitude: f64, phase: f64) -> [f64; 4] {
    [0.0, 1.0, 2.0, 3.0].map(|k| mean + amplitude * (phase - k * FRAC_PI_2).cos())
}
