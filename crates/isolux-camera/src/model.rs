//! What a simulated camera is made of.

use isolux::{Intrinsics, Shape};
use serde::{Deserialize, Serialize};

use crate::document;
use crate::error::{CameraError, InvalidValue, ensure};

/// A time-of-flight camera: lens, light source, pixel and converter (methods, section 1).
///
/// Read one from TOML with [`CameraModel::from_toml`], or take a preset with [`CameraModel::preset`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CameraModel {
    /// Version of the file format: 1.
    pub version: i64,
    /// Name of the camera.
    pub name: String,
    /// Rows of the image.
    pub height: usize,
    /// Columns of the image.
    pub width: usize,
    /// Frequency of the modulated light, Hz.
    pub modulation_frequency_hz: f64,
    /// Modulation contrast m, 0..1: amplitude of the modulation per mean of the active light.
    pub modulation_contrast: f64,
    /// Electrons per µs from a surface of reflectivity 1 that faces the camera at 1 m on the optical axis.
    pub radiometric_electrons_per_us: f64,
    /// Radius of the ring of light sources around the lens, m.
    pub led_ring_radius_m: f64,
    /// Exponent ml of the light sources' lobe `cos^ml`.
    pub lobe_exponent: f64,
    /// Exponent of the lens's fall-off: 4 for cos⁴, 0 for none.
    pub lens_exponent: f64,
    /// Aliased third harmonic h3: the amplitude is multiplied by `1 + h3 cos 4φ`.
    pub third_harmonic: f64,
    /// Full well W, electrons.
    pub full_well_electrons: f64,
    /// Softness p of the full well.
    pub softness: f64,
    /// Hard clip, as a fraction of the full well, below 1.
    pub clip_fraction: f64,
    /// Read noise of one bin, electrons (standard deviation).
    pub read_noise_electrons: f64,
    /// Digital numbers per electron.
    pub gain_dn_per_electron: f64,
    /// Digital number of a bin without charge. It keeps read noise from being cut off at 0.
    pub black_level_dn: f64,
    /// Largest digital number of the converter, at most 65535.
    pub adc_maximum_dn: u16,
    /// Relative excess of the gain in the first frame after a change of the integration time; it decays as
    /// `exp(−frame/τ)`.
    pub warm_up_amplitude: f64,
    /// τ of that decay, frames.
    pub warm_up_frames: f64,
    /// Share of the pixels that deliver nothing, 0..1.
    pub dead_pixel_fraction: f64,
    /// Which pixels those are: they belong to the camera, not to the recording.
    pub dead_pixel_seed: u64,
    /// Amplitude that the camera delivers where a bin is saturated; left out: it delivers what eq. 1 gives.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub saturated_amplitude: Option<f32>,
    /// Integration times that the camera can be set to.
    pub integration_register: IntegrationRegister,
    /// Pinhole intrinsics, pixels.
    #[serde(with = "StrictIntrinsics")]
    pub intrinsics: Intrinsics,
}

/// The core's intrinsics, with unknown fields refused.
#[derive(Serialize, Deserialize)]
#[serde(remote = "Intrinsics", deny_unknown_fields)]
struct StrictIntrinsics {
    fx: f64,
    fy: f64,
    cx: f64,
    cy: f64,
}

/// Integration times as a vendor's interface sets them: `offset + step · n`, n = 0..=maximum.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct IntegrationRegister {
    /// Integration time of register 0, µs.
    pub offset_us: f64,
    /// Integration time that each increment adds, µs.
    pub step_us: f64,
    /// Largest register.
    pub maximum: u32,
}

impl IntegrationRegister {
    /// Integration time of register `n`, µs; `None` beyond the largest register.
    #[must_use]
    pub fn integration_time_us(&self, n: u32) -> Option<f64> {
        (n <= self.maximum).then(|| self.offset_us + self.step_us * f64::from(n))
    }

    /// The register whose integration time is nearest to `integration_time_us`.
    #[must_use]
    pub fn nearest(&self, integration_time_us: f64) -> u32 {
        let n = ((integration_time_us - self.offset_us) / self.step_us).round();
        n.clamp(0.0, f64::from(self.maximum)) as u32
    }
}

impl CameraModel {
    /// Reads a camera from the TOML `text` of the file called `document` (the name is used in errors only).
    ///
    /// # Errors
    /// [`CameraError::Document`] for bad syntax, missing or unknown fields, [`CameraError::Value`] for values
    /// that make no sense, both with the line; [`CameraError::Version`] for a newer format.
    pub fn from_toml(document: &str, text: &str) -> Result<Self, CameraError> {
        let model: Self = document::parse(document, text)?;
        model.validate().map_err(|invalid| document::locate(document, text, invalid))?;
        Ok(model)
    }

    /// Height and width.
    #[must_use]
    pub fn shape(&self) -> Shape {
        Shape::new(self.height, self.width)
    }

    /// Refuses values that make no sense.
    ///
    /// # Errors
    /// [`InvalidValue`] names the first field, its value and the expected range.
    pub fn validate(&self) -> Result<(), InvalidValue> {
        let field = |name: &'static str| move || name.to_owned();
        ensure(self.version == document::VERSION, field("version"), self.version, "1")?;
        ensure(!self.name.trim().is_empty(), field("name"), &self.name, "a name")?;
        for (name, pixels) in [("height", self.height), ("width", self.width)] {
            ensure((1..=8192).contains(&pixels), field(name), pixels, "1 to 8192 pixels")?;
        }
        for (name, value, low, high, expected) in self.ranges() {
            ensure((low..=high).contains(&value), field(name), value, expected)?;
        }
        let code = self.saturated_amplitude.unwrap_or(1.0);
        ensure(
            code > 0.0 && code.is_finite(),
            field("saturated_amplitude"),
            code,
            "a positive number of DN",
        )?;
        ensure(self.adc_maximum_dn > 0, field("adc_maximum_dn"), self.adc_maximum_dn, "1 to 65535 DN")?;
        let expected = "finite numbers, fx and fy positive";
        ensure(self.intrinsics.is_usable(), field("intrinsics"), self.intrinsics, expected)
    }

    /// Name, value, range (ends included) and its wording for every number.
    fn ranges(&self) -> [(&'static str, f64, f64, f64, &'static str); 18] {
        const TINY: f64 = f64::MIN_POSITIVE;
        let register = self.integration_register;
        [
            ("modulation_frequency_hz", self.modulation_frequency_hz, 1e3, 1e10, "1e3 to 1e10 Hz"),
            ("modulation_contrast", self.modulation_contrast, TINY, 1.0, "above 0, at most 1"),
            (
                "radiometric_electrons_per_us",
                self.radiometric_electrons_per_us,
                TINY,
                1e12,
                "above 0, at most 1e12",
            ),
            ("led_ring_radius_m", self.led_ring_radius_m, 0.0, 10.0, "0 to 10 m"),
            ("lobe_exponent", self.lobe_exponent, -1.0, 100.0, "−1 to 100"),
            ("lens_exponent", self.lens_exponent, 0.0, 20.0, "0 (none) to 20; 4 is the cos⁴ law"),
            ("third_harmonic", self.third_harmonic, -0.5, 0.5, "−0.5 to 0.5"),
            ("full_well_electrons", self.full_well_electrons, 1.0, 1e9, "1 to 1e9 electrons"),
            ("softness", self.softness, 1.0, 12.0, "1 to 12"),
            ("clip_fraction", self.clip_fraction, 0.1, 0.999, "0.1 to 0.999"),
            ("read_noise_electrons", self.read_noise_electrons, 0.0, 1e6, "0 to 1e6 electrons"),
            ("gain_dn_per_electron", self.gain_dn_per_electron, TINY, 1e4, "above 0, at most 1e4 DN"),
            ("black_level_dn", self.black_level_dn, 0.0, 65535.0, "0 to 65535 DN"),
            ("warm_up_amplitude", self.warm_up_amplitude, -0.5, 0.5, "−0.5 to 0.5"),
            ("warm_up_frames", self.warm_up_frames, TINY, 1e9, "above 0, at most 1e9 frames"),
            ("dead_pixel_fraction", self.dead_pixel_fraction, 0.0, 1.0, "0 to 1"),
            ("integration_register.offset_us", register.offset_us, TINY, 1e9, "above 0, at most 1e9 µs"),
            ("integration_register.step_us", register.step_us, TINY, 1e9, "above 0, at most 1e9 µs"),
        ]
    }
}
