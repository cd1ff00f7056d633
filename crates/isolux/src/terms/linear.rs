//! `linear`: the amplitude grows in proportion to the integration time (Ritt; eq. 2 of the paper).

/// Multiplier that takes an amplitude from `integration_time_us` to `reference_time_us`: `t_ref / t`.
/// Textbook physics; wrong as soon as pixels saturate.
#[must_use]
pub fn multiplier(integration_time_us: f64, reference_time_us: f64) -> f64 {
    reference_time_us / integration_time_us
}
