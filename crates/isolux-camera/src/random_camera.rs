//! Random cameras, for tests of calibrations on devices that were not used in development.

use isolux::Intrinsics;

use crate::document::VERSION;
use crate::model::{CameraModel, IntegrationRegister};
use crate::noise::{Noise, Purpose};

impl CameraModel {
    /// A camera unlike the presets, but of plausible physics, chosen by `seed`: another format and field of
    /// view, frequency, contrast, lobe, lens, harmonic, well, noise, converter, warm-up and register.
    ///
    /// The built-in scenes suit it: the light is chosen relative to the well so that a white surface at 0.9 m
    /// reaches its largest amplitude between 8 and 48 ms.
    #[must_use]
    pub fn random(seed: u64) -> Self {
        let mut noise = Noise::new(seed, Purpose::RandomCamera, 0);
        let height = noise.between(96.0, 240.0) as usize;
        let width = (height as f64 * noise.between(1.0, 1.5)) as usize;
        let well = libm::exp(noise.between(libm::log(60e3), libm::log(600e3)));
        let read_noise = well * noise.between(1e-4, 4e-4);
        let adc_maximum_dn = [4095, 16383, 65535][noise.between(0.0, 2.999) as usize];
        let gain = noise.between(0.7, 1.0) * f64::from(adc_maximum_dn) / well;
        Self {
            version: VERSION,
            name: format!("random-{seed}"),
            height,
            width,
            modulation_frequency_hz: noise.between(12e6, 40e6),
            modulation_contrast: noise.between(0.3, 0.7),
            radiometric_electrons_per_us: well * noise.between(1.5e-5, 4e-5),
            led_ring_radius_m: noise.between(0.01, 0.1),
            lobe_exponent: noise.between(0.5, 5.0),
            lens_exponent: noise.between(2.5, 4.0),
            third_harmonic: noise.between(-0.03, 0.03),
            full_well_electrons: well,
            softness: noise.between(4.0, 8.0),
            clip_fraction: noise.between(0.93, 0.98),
            read_noise_electrons: read_noise,
            gain_dn_per_electron: gain,
            // Ten standard deviations of the read noise stay above 0, as a maker would adjust it.
            black_level_dn: (10.0 * gain * read_noise).ceil(),
            adc_maximum_dn,
            warm_up_amplitude: noise.between(-0.03, 0.03),
            warm_up_frames: noise.between(5.0, 30.0),
            dead_pixel_fraction: noise.between(0.0, 0.002),
            dead_pixel_seed: seed,
            saturated_amplitude: (noise.uniform() < 0.5).then_some(65535.0),
            integration_register: register(&mut noise),
            intrinsics: intrinsics(&mut noise, height, width),
        }
    }
}

/// A register that reaches 50 ms.
fn register(noise: &mut Noise) -> IntegrationRegister {
    let offset_us = noise.between(20.0, 300.0).round();
    let step_us = noise.between(50.0, 300.0).round();
    IntegrationRegister { offset_us, step_us, maximum: (50_000.0 / step_us).ceil() as u32 }
}

/// 40° to 65° along a row, the principal point a few pixels off the centre.
fn intrinsics(noise: &mut Noise, height: usize, width: usize) -> Intrinsics {
    let half_angle = noise.between(20.0, 32.5).to_radians();
    let focal = 0.5 * width as f64 * libm::cos(half_angle) / libm::sin(half_angle);
    Intrinsics {
        fx: focal,
        fy: focal * noise.between(0.99, 1.01),
        cx: 0.5 * (width as f64 - 1.0) + noise.between(-3.0, 3.0),
        cy: 0.5 * (height as f64 - 1.0) + noise.between(-3.0, 3.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_white_wall_saturates_within_the_register() {
        for seed in 0..200 {
            let camera = CameraModel::random(seed);
            let light = camera.light(0.7, 0.5, 0.9);
            let amplitude = |time_us: &f64| camera.noise_free_amplitude_dn(light, *time_us);
            let times = (0..=camera.integration_register.maximum)
                .filter_map(|n| camera.integration_register.integration_time_us(n));
            let peak_us = times.max_by(|a, b| amplitude(a).total_cmp(&amplitude(b))).unwrap();
            assert!((8_000.0..48_000.0).contains(&peak_us), "{seed}: {peak_us}");
        }
    }

    #[test]
    fn random_cameras_are_valid_differ_and_survive_their_file() {
        let cameras: Vec<_> = (0..50).map(CameraModel::random).collect();
        for (seed, camera) in cameras.iter().enumerate() {
            assert_eq!(camera.validate(), Ok(()), "{seed}");
            let text = toml::to_string(camera).unwrap();
            assert_eq!(&CameraModel::from_toml("random.toml", &text).unwrap(), camera);
            assert_ne!(camera.full_well_electrons, cameras[(seed + 1) % 50].full_well_electrons);
        }
        assert_eq!(CameraModel::random(7), cameras[7]);
    }
}
