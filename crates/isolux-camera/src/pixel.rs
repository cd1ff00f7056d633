//! One pixel without noise: from light to bins, amplitude and its compression.

use crate::full_well::FullWell;
use crate::model::CameraModel;

/// Light on one pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PixelLight {
    /// Mean active light S, electrons per µs.
    pub active_electrons_per_us: f64,
    /// Ambient light B, electrons per µs.
    pub ambient_electrons_per_us: f64,
    /// Radial distance of the surface, m; it sets the phase.
    pub distance_m: f64,
}

impl CameraModel {
    /// Light from a surface at `distance_m`: `S = K · return_factor · h(d)`, `B = K · ambient`.
    ///
    /// `return_factor` is `(ρ cosθ + highlight) v`: 1 for reflectivity 1, facing the camera, on the axis.
    /// `ambient` is relative to K as well.
    #[must_use]
    pub fn light(&self, return_factor: f64, ambient: f64, distance_m: f64) -> PixelLight {
        let active = if distance_m.is_finite() && distance_m > 0.0 {
            self.radiometric_electrons_per_us * return_factor * self.led_decay(distance_m)
        } else {
            0.0
        };
        PixelLight {
            active_electrons_per_us: active,
            ambient_electrons_per_us: self.radiometric_electrons_per_us * ambient,
            distance_m,
        }
    }

    /// Electrons per µs that the four bins receive on average, A1..A4:
    /// `B + S (1 + m (1 + h3 cos 4φ) cos(φ − kπ/2))` (methods, section 1).
    #[must_use]
    pub fn bin_rates_electrons_per_us(&self, light: PixelLight) -> [f64; 4] {
        let mean = light.ambient_electrons_per_us + light.active_electrons_per_us;
        if light.active_electrons_per_us <= 0.0 {
            return [mean; 4];
        }
        let amplitude = self.amplitude_rate_electrons_per_us(light);
        let phase = self.phase(light.distance_m) % std::f64::consts::TAU;
        let (cosine, sine) = (amplitude * libm::cos(phase), amplitude * libm::sin(phase));
        // A strong harmonic on a high contrast would ask for less than no light.
        [mean + cosine, mean + sine, mean - cosine, mean - sine].map(|rate| rate.max(0.0))
    }

    /// Linear amplitude per integration time, `m S (1 + h3 cos 4φ)`, electrons per µs.
    #[must_use]
    pub fn amplitude_rate_electrons_per_us(&self, light: PixelLight) -> f64 {
        if light.active_electrons_per_us <= 0.0 {
            return 0.0;
        }
        self.modulation_contrast * light.active_electrons_per_us * self.harmonic_factor(light.distance_m)
    }

    /// Amplitude of an ideal pixel without noise or saturation, DN: proportional to the integration time.
    #[must_use]
    pub fn linear_amplitude_dn(&self, light: PixelLight, integration_time_us: f64) -> f64 {
        self.gain_dn_per_electron * integration_time_us * self.amplitude_rate_electrons_per_us(light)
    }

    /// Amplitude of the pixel without noise, with saturation, DN: rise, compression, peak, collapse. This is
    /// the truth for a fitted time response.
    #[must_use]
    pub fn noise_free_amplitude_dn(&self, light: PixelLight, integration_time_us: f64) -> f64 {
        let well = FullWell::of(self);
        let [a1, a2, a3, a4] = self
            .bin_rates_electrons_per_us(light)
            .map(|rate| self.bin_dn(well.kept_electrons(integration_time_us * rate)));
        let (cosine, sine) = (a1 - a3, a2 - a4);
        0.5 * (cosine * cosine + sine * sine).sqrt()
    }

    /// Level of a bin that holds `electrons`, limited by the converter but not rounded, DN.
    fn bin_dn(&self, electrons: f64) -> f64 {
        (self.gain_dn_per_electron * electrons + self.black_level_dn).min(f64::from(self.adc_maximum_dn))
    }

    /// Level of a bin that is as full as it can be, DN.
    #[must_use]
    pub fn clip_dn(&self) -> f64 {
        self.bin_dn(FullWell::of(self).clip_electrons())
    }

    /// Noise σ_n of one bin of mean charge `electrons`, electrons: shot noise, read noise and quantization,
    /// `σ_n² = O + σ_r² + 1/(12 g²)` with g in DN per electron (methods, section 1).
    #[must_use]
    pub fn bin_noise_electrons(&self, electrons: f64) -> f64 {
        let step = 1.0 / self.gain_dn_per_electron;
        (electrons + self.read_noise_electrons * self.read_noise_electrons + step * step / 12.0).sqrt()
    }

    /// Excess of the gain over its settled value, `frame` frames after the integration time was changed:
    /// `1 + w exp(−frame/τ)`.
    #[must_use]
    pub fn warm_up_factor(&self, frames_since_change: u64) -> f64 {
        1.0 + self.warm_up_amplitude * libm::exp(-(frames_since_change as f64) / self.warm_up_frames)
    }
}
