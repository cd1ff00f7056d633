//! What the tier is fitted to.

/// What a flat target delivered at one position and integration time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TargetSample {
    /// Integration time, µs.
    pub integration_time_us: f64,
    /// Mean distance in the window, m.
    pub distance_m: f64,
    /// Mean amplitude in the window, DN.
    pub amplitude_dn: f64,
    /// Standard error of the mean amplitude by the noise of its pixels, relative.
    pub relative_error: f64,
    /// Noise of the amplitude, where the position has repeated frames.
    pub noise: Option<NoiseOfSample>,
}

/// Noise of the amplitudes of one position.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NoiseOfSample {
    /// Variance of one amplitude, DN².
    pub variance_dn2: f64,
    /// Number of differences that it was computed from.
    pub differences: f64,
}
