//! `noise`: predicts the variance of an amplitude (DN²) from its light.
//!
//! A bin that holds O electrons has the variance `O + σ_r² + g²/12` (shot, read and quantization noise), and the
//! amplitude of eq. 1 half of it (methods, section 1). In DN that is a constant plus a multiple of the intensity. Where
//! the intensity is not recorded, the amplitude stands for the camera's own light, `a/m`, and the integration time
//! for an ambient light that is the same everywhere.

use serde::{Deserialize, Serialize};

use super::check::{Check, ParameterError, Parameters};
use super::{FitQuality, Source};

mod fit;

pub use fit::NoiseCell;

/// Variance of an amplitude by itself and the integration time:
/// `read + shot · amplitude + ambient · integration time`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AmplitudeNoise {
    /// Read noise and quantization, DN².
    pub read_variance_dn2: f64,
    /// Shot noise of the camera's own light, DN² per DN of amplitude.
    pub shot_variance_dn2_per_dn: f64,
    /// Shot noise of the ambient light, DN² per µs.
    #[serde(default)]
    pub ambient_variance_dn2_per_us: f64,
}

impl AmplitudeNoise {
    /// Variance (DN²) of an amplitude (DN) at an integration time (µs; 0 where it is unknown).
    #[must_use]
    pub fn variance_dn2(&self, amplitude_dn: f64, time_us: f64) -> f64 {
        self.read_variance_dn2
            + self.shot_variance_dn2_per_dn * amplitude_dn
            + self.ambient_variance_dn2_per_us * time_us
    }
}

/// Variance of an amplitude by the intensity, which holds all light: `read + shot · intensity`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct IntensityNoise {
    /// Read noise and quantization, DN².
    pub read_variance_dn2: f64,
    /// Shot noise, DN² per DN of intensity.
    pub shot_variance_dn2_per_dn: f64,
}

/// The noise of a camera's amplitudes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct NoiseModel {
    /// For frames without intensity.
    pub by_amplitude: AmplitudeNoise,
    /// For frames with intensity; `None` uses `by_amplitude` for them too.
    pub by_intensity: Option<IntensityNoise>,
}

/// Noise of the amplitude, fitted.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Noise {
    /// Version of this term's parameters.
    pub version: u32,
    /// For frames without intensity; valid for scenes with the share of ambient light of the fitted scene.
    pub by_amplitude: AmplitudeNoise,
    /// For frames with intensity; absent where the sweep had none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub by_intensity: Option<IntensityNoise>,
    /// The recordings that it was fitted to.
    pub fitted_on: Vec<Source>,
    /// How well it fits: groups of like pixels, and the relative error of their standard deviation.
    pub fit: FitQuality,
}

impl Noise {
    /// Parameter version that this library writes.
    pub const VERSION: u32 = 1;

    /// The numbers alone.
    #[must_use]
    pub fn model(&self) -> NoiseModel {
        NoiseModel { by_amplitude: self.by_amplitude, by_intensity: self.by_intensity }
    }

    /// Refuses parameters that no fit gives.
    ///
    /// # Errors
    /// [`ParameterError`] names the field.
    pub fn check(&self) -> Result<(), ParameterError> {
        self.check_at(&Check::of(Self::NAME))
    }
}

impl Parameters for Noise {
    const NAME: &'static str = "noise";

    fn check_at(&self, here: &Check<'_>) -> Result<(), ParameterError> {
        here.version(self.version, Self::VERSION)?;
        self.model().check_at(here)
    }
}

impl NoiseModel {
    /// Largest coefficient: far beyond any camera, and squares of it are still finite in f32.
    const LARGEST: f64 = 1e12;

    /// Refuses variances that are negative or nothing at all.
    ///
    /// # Errors
    /// [`ParameterError`] names the field.
    pub fn check(&self) -> Result<(), ParameterError> {
        self.check_at(&Check::of(Noise::NAME))
    }

    fn check_at(&self, here: &Check<'_>) -> Result<(), ParameterError> {
        let AmplitudeNoise { read_variance_dn2, shot_variance_dn2_per_dn, ambient_variance_dn2_per_us } =
            self.by_amplitude;
        let numbers = [read_variance_dn2, shot_variance_dn2_per_dn, ambient_variance_dn2_per_us];
        check_variances(&here.at("by_amplitude"), &numbers)?;
        let Some(IntensityNoise { read_variance_dn2, shot_variance_dn2_per_dn }) = self.by_intensity else {
            return Ok(());
        };
        check_variances(&here.at("by_intensity"), &[read_variance_dn2, shot_variance_dn2_per_dn])
    }
}

fn check_variances(here: &Check<'_>, numbers: &[f64]) -> Result<(), ParameterError> {
    let fine = numbers.iter().all(|number| (0.0..=NoiseModel::LARGEST).contains(number));
    let expected = "variances from 0 to 1e12, not all of them 0";
    here.require(fine && numbers.iter().sum::<f64>() > 0.0, format!("{numbers:?}"), expected)
}
