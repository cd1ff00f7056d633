//! Noise and outliers of a known size instead of the camera's own.

use isolux::phase::SPEED_OF_LIGHT_M_PER_S;
use isolux::{Frame, PixelFlags};
use isolux_camera::{CameraModel, Truth};

/// How frames are spoilt.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spoil {
    /// Standard deviation of ln A. The phase has the same (`σ_φ = σ_a/a`, methods, section 1), and so the distance
    /// `c σ_φ / 4π f`.
    pub noise: f64,
    /// Share of the pixels whose amplitude is any other, 0..=1.
    pub outlier_share: f64,
}

impl Spoil {
    /// Two percent noise and five percent outliers.
    pub const USUAL: Self = Self { noise: 0.02, outlier_share: 0.05 };

    /// Replaces amplitude and distance by the true ones (saturation included), spoilt. Outliers lie anywhere between 0
    /// and three times the true amplitude.
    pub(super) fn apply(self, truth: &Truth, camera: &CameraModel, seed: u64, frame: &mut Frame) {
        let mut random = Random(seed);
        let noise_m = self.noise * SPEED_OF_LIGHT_M_PER_S
            / (4.0 * std::f64::consts::PI * camera.modulation_frequency_hz);
        let range_m = camera.ambiguity_range_m();
        for index in 0..frame.amplitude.values().len() {
            let amplitude = f64::from(truth.noise_free_amplitude.values()[index]);
            let distance_m = f64::from(truth.true_distance_m.values()[index]);
            let (a, d) = random.normal_pair();
            let amplitude = if random.uniform() < self.outlier_share {
                3.0 * amplitude * random.uniform()
            } else {
                amplitude * (self.noise * a).exp()
            };
            frame.amplitude.values_mut()[index] = amplitude as f32;
            if let Some(plane) = &mut frame.distance_m {
                plane.values_mut()[index] = (distance_m + noise_m * d).rem_euclid(range_m) as f32;
            }
        }
        frame.flags.fill(PixelFlags::empty());
        frame.flag_amplitude(camera.saturated_amplitude);
    }
}

/// SplitMix64 (Steele, Lea and Flood 2014): these frames need no better one.
struct Random(u64);

impl Random {
    /// Uniform in 0..1, 53 bits.
    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut bits = self.0;
        bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((bits ^ (bits >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Two standard normal numbers (Box and Muller 1958).
    fn normal_pair(&mut self) -> (f64, f64) {
        let radius = (-2.0 * (1.0 - self.uniform()).ln()).sqrt();
        let (sine, cosine) = (std::f64::consts::TAU * self.uniform()).sin_cos();
        (radius * cosine, radius * sine)
    }
}
