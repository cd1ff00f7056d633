//! The mean curve of an exposure sweep, measured or relative.

/// The mean image amplitude at one integration time of an exposure sweep.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ExposureSample {
    /// Integration time, µs.
    pub integration_time_us: f64,
    /// Mean amplitude of the valid pixels over all frames of this time, DN.
    pub mean_amplitude_dn: f64,
    /// Root mean square of the relative deviation of single frames from that mean.
    pub frame_spread: f64,
}

/// One point of a curve of which only the ratios count.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RelativeSample {
    /// Integration time, µs.
    pub integration_time_us: f64,
    /// Amplitude over that of some other time, or in any unit that all samples share.
    pub relative_amplitude: f64,
    /// Relative standard deviation of `relative_amplitude`.
    pub spread: f64,
}

impl From<ExposureSample> for RelativeSample {
    fn from(sample: ExposureSample) -> Self {
        let ExposureSample { integration_time_us, mean_amplitude_dn, frame_spread } = sample;
        Self { integration_time_us, relative_amplitude: mean_amplitude_dn, spread: frame_spread }
    }
}
