//! The simulated camera against the closed forms of its physics.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

mod common;

use common::{centre, deviation, flat_sr3100, mean, render, scene, settled_sr3100, surrounding, wall};
use isolux::phase::SPEED_OF_LIGHT_M_PER_S;
use isolux_camera::scene::object::{Form, Highlight, Object};
use isolux_camera::scene::run::Move;
use isolux_camera::scene::texture::Texture;
use isolux_camera::{CameraModel, FullWell};

/// Relative error of one f32 rounding, twice: the truth is computed in f64 and stored in f32.
const F32: f64 = 1.2e-7;

#[test]
fn the_truth_of_a_wall_is_the_closed_form() {
    let model = settled_sr3100();
    let (depth_m, reflectivity, time_us) = (1.3, 0.6, 3000.0);
    let out = render(model.clone(), scene(vec![wall(depth_m, reflectivity)], 0.2, &[time_us]), 0);
    for (row, column) in [(0, 0), (71, 88), (143, 20), (10, 175)] {
        let x = (column as f64 - model.intrinsics.cx) / model.intrinsics.fx;
        let y = (row as f64 - model.intrinsics.cy) / model.intrinsics.fy;
        let cosine = 1.0 / (1.0 + x * x + y * y).sqrt();
        let distance = depth_m / cosine;
        let ring = |d: f64| {
            (d * d / (d * d + model.led_ring_radius_m.powi(2))).powf((model.lobe_exponent + 3.0) / 2.0)
                / (d * d)
        };
        let phase =
            4.0 * std::f64::consts::PI * model.modulation_frequency_hz * distance / SPEED_OF_LIGHT_M_PER_S;
        let profile = cosine.powf(model.lobe_exponent + 4.0);
        let expected = model.gain_dn_per_electron
            * model.modulation_contrast
            * model.radiometric_electrons_per_us
            * reflectivity
            * cosine
            * profile
            * ring(distance)
            / ring(1.0)
            * (1.0 + model.third_harmonic * (4.0 * phase).cos())
            * time_us;
        let at = |plane: &isolux::Plane<f32>| f64::from(plane.get(row, column).unwrap());
        assert!((at(&out.truth.linear_amplitude) / expected - 1.0).abs() < F32);
        assert!((at(&out.truth.true_distance_m) / distance - 1.0).abs() < F32);
        assert!((at(&out.truth.cos_incidence) / cosine - 1.0).abs() < F32);
        assert!((model.illumination_profile_at(row as f64, column as f64) / profile - 1.0).abs() < 1e-12);
        let standardized = out.truth.true_standardized(&model, 8200.0, 0.75);
        let response = model.distance_response(distance, 0.75) * time_us / 8200.0;
        assert!((at(&standardized) * response / expected - 1.0).abs() < 3.0 * F32);
        let material = out.truth.true_standardized_material(&model, 8200.0, 0.75);
        assert!((at(&standardized) / at(&material) / (cosine * profile) - 1.0).abs() < 4.0 * F32);
    }
}

#[test]
fn the_delivered_amplitude_scatters_about_the_truth() {
    // Dim enough that f′ is 1 to 1e-6, bright enough that the Rician bias 1/(2 SNR²) stays below 1e-4.
    let out = render(flat_sr3100(), scene(vec![surrounding(1.0, 0.5)], 0.1, &[4000.0]), 0);
    let amplitude = out.frame.amplitude.values();
    let (expected, found) = (f64::from(out.truth.linear_amplitude.values()[0]), mean(amplitude.to_vec()));
    let standard_error = deviation(amplitude) / (amplitude.len() as f64).sqrt();
    assert!((found - expected).abs() < 5.0 * standard_error + 1e-4 * expected, "{found} {expected}");
}

#[test]
fn amplitude_and_distance_noise_follow_the_formulas() {
    let model = flat_sr3100();
    let (time_us, distance_m) = (4000.0, 1.0);
    let out = render(model.clone(), scene(vec![surrounding(distance_m, 0.8)], 0.3, &[time_us]), 0);
    let light = model.light(0.8, 0.3 * 0.8, distance_m);
    let offset = time_us * (light.active_electrons_per_us + light.ambient_electrons_per_us);
    let bin_noise = model.bin_noise_electrons(offset);
    let amplitude = time_us * model.amplitude_rate_electrons_per_us(light);
    // Standard error of a standard deviation 1/√(2N), five of them; second-order terms are of 1/SNR² < 4e-4.
    let samples = out.frame.amplitude.values().len() as f64;
    let tolerance = 5.0 / (2.0 * samples).sqrt() + 4e-4;
    let found = deviation(out.frame.amplitude.values());
    let expected = model.gain_dn_per_electron * bin_noise / 2f64.sqrt();
    assert!((found / expected - 1.0).abs() < tolerance, "σ_a {found} {expected}");
    let found = deviation(out.frame.distance_m.as_ref().unwrap().values());
    let expected = SPEED_OF_LIGHT_M_PER_S
        / (4.0 * 2f64.sqrt() * std::f64::consts::PI * model.modulation_frequency_hz)
        * bin_noise
        / amplitude;
    assert!((found / expected - 1.0).abs() < tolerance, "σ_d {found} {expected}");
    let intensity = mean(out.frame.intensity.as_ref().unwrap().values().to_vec());
    assert!((intensity / (model.gain_dn_per_electron * offset) - 1.0).abs() < 1e-3, "{intensity}");
}

#[test]
fn without_a_return_the_amplitude_is_the_rician_floor_and_the_distance_is_anything() {
    let model = flat_sr3100();
    let (ambient, time_us) = (0.5, 2000.0);
    let out = render(model.clone(), scene(vec![], ambient, &[time_us]), 0);
    let offset = time_us * ambient * model.radiometric_electrons_per_us;
    let noise = model.gain_dn_per_electron * model.bin_noise_electrons(offset) / 2f64.sqrt();
    let (floor, scatter) = (1.253_314 * noise, 0.655_136 * noise);
    let amplitude = out.frame.amplitude.values();
    let tolerance = 5.0 * scatter / (amplitude.len() as f64).sqrt();
    assert!((mean(amplitude.to_vec()) - floor).abs() < tolerance);
    // Uniform over the ambiguity range: deviation range/√12, its estimate to 1 %.
    let distance: Vec<f32> =
        out.frame.distance_m.as_ref().unwrap().values().iter().copied().filter(|d| d.is_finite()).collect();
    let expected = model.ambiguity_range_m() / 12f64.sqrt();
    assert!((deviation(&distance) / expected - 1.0).abs() < 0.02);
    assert!(out.truth.true_distance_m.values().iter().all(|distance| distance.is_nan()));
    assert_eq!(out.truth.linear_amplitude.values()[0], 0.0);
}

#[test]
fn distances_beyond_the_ambiguity_range_wrap() {
    let model = flat_sr3100();
    let bright = CameraModel { radiometric_electrons_per_us: 2000.0, ..model };
    let out = render(bright.clone(), scene(vec![surrounding(9.0, 0.8)], 0.0, &[4000.0]), 0);
    let found = mean(centre(out.frame.distance_m.as_ref().unwrap()));
    assert!((found - (9.0 - bright.ambiguity_range_m())).abs() < 0.01, "{found}");
    assert!((mean(centre(&out.truth.true_distance_m)) - 9.0).abs() < 1e-6);
}

#[test]
fn the_delivered_distance_is_the_cores() {
    let model = settled_sr3100();
    let out = render(model.clone(), scene(vec![wall(1.1, 0.5)], 0.2, &[1000.0]), 0);
    let bins = out.frame.phase_samples.as_ref().unwrap();
    for index in (0..out.frame.amplitude.values().len()).step_by(7) {
        let bins = bins.each_ref().map(|plane| plane.values()[index]);
        let expected = isolux::phase::distance_m(bins, model.modulation_frequency_hz, false);
        let found = out.frame.distance_m.as_ref().unwrap().values()[index];
        // One unit in the last place of a number below 8 m.
        assert!((found - expected).abs() < 5e-7, "{found} {expected}");
        assert_eq!(out.frame.amplitude.values()[index], isolux::phase::amplitude(bins));
        assert_eq!(out.phase_samples[2].values()[index], bins[2] as u16);
    }
}

#[test]
fn the_ring_of_lights_weakens_the_near_range_and_contains_equation_5() {
    let ring = CameraModel { led_ring_radius_m: 0.1, lobe_exponent: 2.0, ..settled_sr3100() };
    let slope = |near: f64, far: f64| (ring.led_decay(far) / ring.led_decay(near)).ln() / (far / near).ln();
    // d ln h / d ln z = −2 + (ml+3) R²/(z²+R²): −2 far away, flat where that term reaches 2.
    assert!((slope(10.0, 10.001) + 2.0).abs() < 1e-3);
    let near = 0.15f64;
    let expected = -2.0 + 5.0 * 0.01 / (near * near + 0.01);
    assert!((slope(near - 1e-5, near + 1e-5) - expected).abs() < 1e-6);
    let equation_5 = CameraModel { led_ring_radius_m: 0.5, lobe_exponent: -1.0, ..settled_sr3100() };
    let formula = |d: f64| 1.0 / ((2.0 * d).powi(2) + 1.0);
    for distance in [0.1, 0.75, 3.0] {
        let expected = formula(distance) / formula(1.0);
        assert!((equation_5.led_decay(distance) / expected - 1.0).abs() < 1e-12);
    }
}

#[test]
fn the_harmonic_modulates_the_amplitude_four_times_over_the_ambiguity_range() {
    let model = CameraModel { third_harmonic: 0.03, ..settled_sr3100() };
    let range = model.ambiguity_range_m();
    for quarter in 0..4 {
        let start = 0.25 * range * f64::from(quarter);
        assert!((model.harmonic_factor(start) - 1.03).abs() < 1e-9);
        assert!((model.harmonic_factor(start + 0.125 * range) - 0.97).abs() < 1e-9);
    }
    // The bins carry it: the amplitude that eq. 1 finds in them is the linear one.
    let light = model.light(0.7, 0.1, 1.0);
    let [a1, a2, a3, a4] = model.bin_rates_electrons_per_us(light);
    let found = 0.5 * (a1 - a3).hypot(a2 - a4);
    assert!((found / model.amplitude_rate_electrons_per_us(light) - 1.0).abs() < 1e-12);
}

#[test]
fn ambient_light_brings_saturation_earlier() {
    let model = settled_sr3100();
    let peak_us = |ambient: f64| {
        let light = model.light(0.7, ambient, 0.9);
        let amplitude = |step: &u32| model.noise_free_amplitude_dn(light, f64::from(*step) * 100.0);
        (1..1000).max_by(|a, b| amplitude(a).total_cmp(&amplitude(b))).unwrap()
    };
    let peaks = [0.0, 0.5, 1.0, 2.0].map(peak_us);
    assert!(peaks.windows(2).all(|pair| pair[1] < pair[0]), "{peaks:?}");
}

#[test]
fn compression_follows_the_slope_of_the_well_at_the_offset() {
    // Eq. 3: a/a_lin ≈ f′(O) for a small modulation.
    let model = CameraModel { modulation_contrast: 0.02, third_harmonic: 0.0, ..settled_sr3100() };
    let well = FullWell::of(&model);
    let light = model.light(0.7, 0.4, 0.9);
    let rate = light.active_electrons_per_us + light.ambient_electrons_per_us;
    for fill in [0.3, 0.7, 0.9, 1.0] {
        let offset = fill * model.full_well_electrons;
        let time_us = offset / rate;
        let ratio = model.noise_free_amplitude_dn(light, time_us) / model.linear_amplitude_dn(light, time_us);
        // Third order: |f‴| (m S t)²/24 < p² (0.015)²/24 ≈ 6e-4.
        assert!((ratio - well.slope(offset)).abs() < 1e-3, "{fill}: {ratio}");
    }
    let over_saturated = model.noise_free_amplitude_dn(light, 3.0 * model.full_well_electrons / rate);
    assert_eq!(over_saturated, 0.0);
}

#[test]
fn highlights_appear_where_the_surface_faces_the_camera() {
    let mut ball =
        Object::new("ball", Form::Sphere { radius_m: 0.2 }, [0.0, 0.0, 1.0], Texture::Uniform(0.2));
    ball.highlight = Some(Highlight { strength: 2.0, exponent: 200.0 });
    let out = render(settled_sr3100(), scene(vec![ball, wall(2.0, 0.5)], 0.0, &[1000.0]), 0);
    let factor = |row, column| out.truth.return_factor.get(row, column).unwrap();
    // Half a pixel right of and below it: an angle on the ball of √2 · 0.5 px / 200 px · 1.0 m / 0.2 m.
    let angle = 2f64.sqrt() * 0.5 / 200.0 / 0.2;
    let expected = 0.2 * angle.cos() + 2.0 * angle.cos().powi(200);
    assert!((f64::from(factor(71, 87)) / expected - 1.0).abs() < 1e-3, "{} {expected}", factor(71, 87));
    assert!(factor(71, 110) < 0.2);
    assert!(out.truth.specular_fraction.get(71, 87).unwrap() > 0.9);
    assert_eq!(out.truth.specular_fraction.get(5, 5), Some(0.0));
}

#[test]
fn dead_pixels_are_dead_and_belong_to_the_camera() {
    let model = CameraModel { dead_pixel_fraction: 0.01, ..settled_sr3100() };
    let dead = |seed| {
        let scene = scene(vec![wall(1.0, 0.5)], 0.1, &[2000.0]);
        let simulation = isolux_camera::Simulation::new(model.clone(), scene, seed).unwrap();
        let mut out = isolux_camera::SimulatedFrame::new(simulation.shape());
        simulation.render_frame(0, &mut out).unwrap();
        for (index, &dead) in simulation.dead_pixels().iter().enumerate() {
            assert_eq!(dead, out.frame.amplitude.values()[index] == 0.0);
            assert_eq!(dead, !out.frame.is_valid(index));
            assert_eq!(dead, out.frame.distance_m.as_ref().unwrap().values()[index].is_nan());
        }
        simulation.dead_pixels().to_vec()
    };
    assert_eq!(dead(1), dead(2));
    let count = dead(1).iter().filter(|&&dead| dead).count() as f64;
    assert!((count - 253.0).abs() < 5.0 * 253f64.sqrt(), "{count}");
}

#[test]
fn a_camera_with_a_code_delivers_it_where_a_bin_is_saturated() {
    let model = CameraModel { saturated_amplitude: Some(65535.0), ..flat_sr3100() };
    let out = render(model.clone(), scene(vec![surrounding(0.5, 0.9)], 0.0, &[200.0, 20_000.0]), 1);
    assert!(out.frame.amplitude.values().iter().all(|&amplitude| amplitude == 65535.0));
    assert!(out.frame.flags.values().iter().all(|flags| flags.contains(isolux::PixelFlags::SATURATED)));
    let dim = render(model, scene(vec![surrounding(0.5, 0.9)], 0.0, &[200.0, 20_000.0]), 0);
    assert!((0..dim.frame.amplitude.values().len()).all(|index| dim.frame.is_valid(index)));
}

#[test]
fn a_converter_that_ends_before_the_well_delivers_nothing_when_over_saturated() {
    let model = CameraModel::preset("o3d-like").unwrap();
    let model = CameraModel { lobe_exponent: 0.0, lens_exponent: 0.0, ..model };
    assert_eq!(model.clip_dn(), 4095.0);
    let out = render(model, scene(vec![surrounding(0.5, 0.9)], 0.3, &[100_000.0]), 0);
    assert!(out.frame.amplitude.values().iter().all(|&amplitude| amplitude == 0.0));
    assert!((0..out.frame.amplitude.values().len()).all(|index| !out.frame.is_valid(index)));
    let distance_m = out.frame.distance_m.as_ref().unwrap();
    assert!(distance_m.values().iter().all(|distance| distance.is_nan()));
}

#[test]
fn a_camera_that_moves_sees_from_where_it_is() {
    let mut scene = scene(vec![wall(2.0, 0.5)], 0.0, &[1000.0]);
    let step = Move { object: "camera".to_owned(), center_m: Some([0.3, 0.0, 0.5]), ..Move::default() };
    scene.runs[0].moves = vec![step.clone(), Move { yaw_deg: Some(20.0), ..step }];
    let straight = render(settled_sr3100(), scene.clone(), 0);
    let turned = render(settled_sr3100(), scene, 1);
    let axis = |out: &isolux_camera::SimulatedFrame| mean(centre(&out.truth.true_distance_m));
    // The window is symmetric about the axis to half a pixel; over it the distance varies by 0.1 %.
    assert!((axis(&straight) - 1.5).abs() < 3e-3, "{}", axis(&straight));
    assert!((axis(&turned) - 1.5 / 20f64.to_radians().cos()).abs() < 5e-3, "{}", axis(&turned));
    let pose = turned.frame.world_from_camera.unwrap();
    assert_eq!([pose[0][3], pose[1][3], pose[2][3]], [0.3, 0.0, 0.5]);
    assert!((pose[0][2] - 20f64.to_radians().sin()).abs() < 1e-12);
}
