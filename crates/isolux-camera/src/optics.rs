//! Light from the source to the pixel: decay over distance, illumination profile, harmonic.

use std::f64::consts::{PI, TAU};

use isolux::phase::SPEED_OF_LIGHT_M_PER_S;
use isolux::{Intrinsics, Plane};

use crate::model::CameraModel;

impl CameraModel {
    /// Distance at which the phase starts again, `c / 2f`, m.
    #[must_use]
    pub fn ambiguity_range_m(&self) -> f64 {
        SPEED_OF_LIGHT_M_PER_S / (2.0 * self.modulation_frequency_hz)
    }

    /// Phase `4π f d / c` of the light from `distance_m`, not wrapped, rad.
    #[must_use]
    pub fn phase(&self, distance_m: f64) -> f64 {
        4.0 * PI * self.modulation_frequency_hz * distance_m / SPEED_OF_LIGHT_M_PER_S
    }

    /// Decay h of the active light over distance, 1 at 1 m, for a ring of lobes around the lens:
    /// `h(d) = d⁻² (d²/(d²+R²))^((ml+3)/2)` (methods, section 1). ml = −1 and R = 0.5 m give eq. 5 of Stürmer,
    /// Penne and Hornegger (2008).
    #[must_use]
    pub fn led_decay(&self, distance_m: f64) -> f64 {
        let decay = |distance_m: f64| {
            let squared = distance_m * distance_m;
            let ring = squared + self.led_ring_radius_m * self.led_ring_radius_m;
            libm::pow(squared / ring, 0.5 * (self.lobe_exponent + 3.0)) / squared
        };
        decay(distance_m) / decay(1.0)
    }

    /// Factor `1 + h3 cos 4φ` of the aliased third harmonic on the amplitude, dimensionless.
    #[must_use]
    pub fn harmonic_factor(&self, distance_m: f64) -> f64 {
        // cos of the wrapped phase: libm's argument reduction is exact, but the wrap keeps 4φ small.
        let phase = self.phase(distance_m) % TAU;
        1.0 + self.third_harmonic * libm::cos(4.0 * phase)
    }

    /// Amplitude at `distance_m` relative to the amplitude at `reference_distance_m`, everything else equal:
    /// decay and harmonic. This is the truth for a fitted distance term (its multiplier is the inverse).
    #[must_use]
    pub fn distance_response(&self, distance_m: f64, reference_distance_m: f64) -> f64 {
        let response = |distance_m| self.led_decay(distance_m) * self.harmonic_factor(distance_m);
        response(distance_m) / response(reference_distance_m)
    }

    /// Illumination profile v at (row, column), 1 on the optical axis: `cos^ml(α) cos⁴(α)`, α the angle between
    /// the pixel's ray and the axis. This is the truth for a fitted profile.
    #[must_use]
    pub fn illumination_profile_at(&self, row: f64, column: f64) -> f64 {
        libm::pow(cosine_off_axis(&self.intrinsics, row, column), self.lobe_exponent + self.lens_exponent)
    }

    /// [`CameraModel::illumination_profile_at`] of every pixel.
    #[must_use]
    pub fn illumination_profile(&self) -> Plane<f32> {
        Plane::from_fn(self.shape(), |row, column| {
            self.illumination_profile_at(row as f64, column as f64) as f32
        })
    }

    /// Fall-off of the lens alone at (row, column), which ambient light suffers too, 1 on the axis.
    #[must_use]
    pub fn lens_factor_at(&self, row: f64, column: f64) -> f64 {
        libm::pow(cosine_off_axis(&self.intrinsics, row, column), self.lens_exponent)
    }
}

/// Cosine of the angle between the pixel's ray and the optical axis.
fn cosine_off_axis(intrinsics: &Intrinsics, row: f64, column: f64) -> f64 {
    let [x, y, z] = intrinsics.ray(row, column);
    z / (x * x + y * y + z * z).sqrt()
}
