//! The fits recover what the simulated camera is, within the noise that its frames carry.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "tests fail by panicking")]

mod common;

use common::naive_fit::{self, NaiveCubic, Weighting};
use common::noise_theory::{ExpectedMean, mean_curve, rice_mean};
use common::{builtin, calibrate, cropped, render, time_us};
use isolux::calibrate::CalibrateSettings;
use isolux::terms::Lut;
use isolux::{Calibration, Window};
use isolux_camera::{CameraModel, Scene, SimulatedFrame, Simulation};

/// Standard errors that a deviation may have: 1 in 1.7 million for one comparison, and there are some hundred.
const STANDARD_ERRORS: f64 = 5.0;
const REFERENCE_US: f64 = 8200.0;
const REFERENCE_M: f64 = 0.75;

fn lut_of(calibration: &Calibration) -> &Lut {
    calibration.terms.lut.as_ref().unwrap()
}

/// The multiplier S(t) is a ratio of two means of N pixels and n frames. The expectation of each is known: the
/// noise-free mean, plus Rice's bias (2 % of the mean at a signal-to-noise ratio of 5, which the corners of the
/// image have at 0.2 ms), less what shot noise loses at the clip. Its standard error is σ_a/√(N n). Warm-up is in
/// the truth. So `S(t) / S_true(t) − 1` scatters with the two relative standard errors, squared and added.
#[test]
fn the_table_is_the_cameras_mean_curve_within_the_noise_of_a_mean() {
    let simulation = builtin("wall-sweep-smoke", 1);
    let frames = render(&simulation);
    let calibration = calibrate(&CalibrateSettings::default(), &frames, &[]);
    let lut = lut_of(&calibration);
    let truth = mean_curve(&simulation, &frames);
    let at = |time: f64| truth.iter().find(|mean| mean.integration_time_us == time).unwrap();
    let relative_error = |mean: &ExpectedMean| mean.standard_error_dn / mean.expected_dn;
    let reference = at(REFERENCE_US);
    for (&time, &multiplier) in lut.integration_time_us.iter().zip(&lut.multiplier) {
        let expected = at(time);
        let deviation = multiplier * expected.expected_dn / reference.expected_dn - 1.0;
        let tolerance = STANDARD_ERRORS * relative_error(expected).hypot(relative_error(reference));
        assert!(deviation.abs() <= tolerance, "{time} µs: {deviation:e}, {tolerance:e} allowed");
        // The proof is sharp: 0.5 % where the signal is dim, 0.1 % where it is not.
        assert!(tolerance < if time < 2000.0 { 5e-3 } else { 1e-3 }, "{time} µs: {tolerance:e}");
        // Noise explains all that separates the table from the noise-free curve.
        let bias = expected.expected_dn / expected.noise_free_dn - 1.0;
        assert!(bias.abs() < if time < 1000.0 { 0.05 } else { 3e-3 }, "{time} µs: {bias:e}");
    }
    the_table_ends_at_the_peak(lut, &truth);
}

/// The last time of the table has the largest true mean, or one that noise cannot tell from it.
fn the_table_ends_at_the_peak(lut: &Lut, truth: &[ExpectedMean]) {
    let peak = truth.iter().max_by(|a, b| a.expected_dn.total_cmp(&b.expected_dn)).unwrap();
    let end = lut.valid_integration_time_us[1];
    let last = truth.iter().find(|mean| mean.integration_time_us == end).unwrap();
    let noise = STANDARD_ERRORS * last.standard_error_dn.hypot(peak.standard_error_dn);
    assert!(peak.expected_dn - last.expected_dn <= noise, "{end} µs, {}", peak.integration_time_us);
    assert!(end < truth[truth.len() - 1].integration_time_us, "the sweep goes on beyond the peak");
}

/// The SR-3100 without saturation, warm-up, dead pixels and ambient light, and of 40×40 pixels: what is left is
/// the decay, the harmonic, and noise.
fn unsaturated() -> CameraModel {
    let mut model = cropped("sr3100", 40, 40);
    (model.full_well_electrons, model.gain_dn_per_electron) = (1e8, 0.015);
    (model.warm_up_amplitude, model.dead_pixel_fraction) = (0.0, 0.0);
    model
}

fn board() -> Scene {
    let text = r#"
        version = 1
        name = "board"
        [[object]]
        name = "board"
        form = { rectangle = { size_m = [1.6, 1.4] } }
        center_m = [0.0, 0.0, 1.0]
        texture = { uniform = 0.85 }
        [[run]]
        integration_times_us = [8200.0, 12000.0, 16400.0]
        frames_per_time = 4
        [run.approach]
        object = "board"
        distances_m = [0.35, 0.4, 0.45, 0.5, 0.6, 0.7, 0.8, 1.0, 1.2, 1.5, 1.8, 2.2, 2.6, 3.0]
    "#;
    Scene::from_toml("board", text).unwrap()
}

/// One position of one decay: what is true there, and the relative noise of its window's mean.
#[derive(Clone, Copy, Debug)]
struct TruePosition {
    distance_m: f64,
    amplitude_dn: f64,
    amplitude_noise: f64,
    distance_noise: f64,
}

/// With O = a/m electrons in a bin on average, a bin's noise is σ_n and the amplitude's σ_a = σ_n/√2; the distance's
/// is σ_d = c/(4πf) σ_a/a. Means over the window's pixels and the frames divide both by √(N n).
fn true_position(model: &CameraModel, simulated: &SimulatedFrame, frames: f64) -> TruePosition {
    let shape = model.shape();
    let window: Vec<usize> = Window::centred(shape, 20).indices(shape).collect();
    let count = window.len() as f64;
    let mean = |plane: &isolux::Plane<f32>| {
        window.iter().map(|&i| f64::from(plane.values()[i])).sum::<f64>() / count
    };
    let noise_free = mean(&simulated.truth.noise_free_amplitude);
    let electrons = noise_free / model.gain_dn_per_electron;
    let bin = model.bin_noise_electrons(electrons / model.modulation_contrast);
    let amplitude_sd = bin / 2f64.sqrt();
    let distance_m = mean(&simulated.truth.true_distance_m);
    let per_phase_m = model.ambiguity_range_m() / std::f64::consts::TAU;
    let averaged = (count * frames).sqrt();
    TruePosition {
        distance_m,
        amplitude_dn: noise_free / electrons * rice_mean(electrons, amplitude_sd * amplitude_sd),
        amplitude_noise: amplitude_sd / electrons / averaged,
        distance_noise: per_phase_m * amplitude_sd / electrons / distance_m / averaged,
    }
}

/// The bound at each distance is what the best cubic leaves of the true curve (a cubic cannot follow 1/h with
/// the harmonic cos 4φ) plus what noise makes of the fit. The best cubic is a naive implementation's, fitted on
/// noise-free positions; the fit's noise at a distance is the spread of that implementation's results over 100
/// sets of positions to which the noise of a window's mean was added, to amplitude and distance.
#[test]
fn the_cubic_is_the_cameras_true_decay_as_well_as_a_cubic_can_be_within_noise() {
    let simulation = Simulation::new(unsaturated(), board(), 11).unwrap();
    let (model, frames) = (simulation.model(), render(&simulation));
    let calibration = calibrate(&CalibrateSettings::default(), &[], &frames);
    let cubic = calibration.terms.cubic.unwrap();
    let truth = true_decays(model, &frames);
    let best = fit_naively(&truth, |_| (1.0, 1.0));
    let mut normal = Normal(5);
    let noisy: Vec<NaiveCubic> = (0..100)
        .map(|_| {
            fit_naively(&truth, |position| {
                let relative = |noise: f64, normal: &mut Normal| 1.0 + noise * normal.next();
                let distance = relative(position.distance_noise, &mut normal);
                (distance, relative(position.amplitude_noise, &mut normal))
            })
        })
        .collect();
    let [min, max] = cubic.valid_distance_m;
    // The ends are the outermost positions, as they were measured: a board at z is z/cos α away.
    assert!((min / 0.35 - 1.0).abs() < 5e-3 && (max / 3.0 - 1.0).abs() < 5e-3, "{min} {max}");
    for step in 0..=100 {
        let distance = min + (max - min) * f64::from(step) / 100.0;
        let true_multiplier = 1.0 / model.distance_response(distance, REFERENCE_M);
        let found = naive_fit::polynomial(cubic.coefficients, distance) / true_multiplier - 1.0;
        let family = best.at(distance) / true_multiplier - 1.0;
        let spread =
            noisy.iter().map(|fit| (fit.at(distance) / best.at(distance) - 1.0).powi(2)).sum::<f64>();
        let noise = STANDARD_ERRORS * (spread / 100.0).sqrt();
        assert!(found.abs() <= family.abs() + noise, "{distance:.3} m: {found:e} {family:e} {noise:e}");
        // The proof is sharp: noise allows little, and the fit is nowhere farther from the best cubic.
        assert!(
            (found - family).abs() <= noise && noise < 5e-3,
            "{distance:.3} m: {found:e} {family:e} {noise:e}"
        );
        assert!(family.abs() < 0.04, "{distance:.3} m: {family:e}");
    }
    let at_reference = naive_fit::polynomial(cubic.coefficients, REFERENCE_M);
    assert!((at_reference - 1.0).abs() < 1e-12, "{at_reference}");
}

fn true_decays(model: &CameraModel, frames: &[SimulatedFrame]) -> Vec<Vec<TruePosition>> {
    let positions = frames.chunks(4).map(|frames| (time_us(&frames[0].frame), &frames[0]));
    let positions: Vec<_> = positions.map(|(time, frame)| (time, true_position(model, frame, 4.0))).collect();
    [8200.0, 12000.0, 16400.0]
        .map(|time| positions.iter().filter(|(t, _)| *t == time).map(|(_, position)| *position).collect())
        .into()
}

/// The naive cubic of the positions, each of whose distance and amplitude is multiplied by `factors`.
fn fit_naively(
    decays: &[Vec<TruePosition>],
    mut factors: impl FnMut(&TruePosition) -> (f64, f64),
) -> NaiveCubic {
    let decay = |positions: &Vec<TruePosition>| {
        let point = |position: &TruePosition| {
            let (distance, amplitude) = factors(position);
            (position.distance_m * distance, position.amplitude_dn * amplitude)
        };
        positions.iter().map(point).collect()
    };
    let points: Vec<Vec<(f64, f64)>> = decays.iter().map(decay).collect();
    naive_fit::paper_cubic(&points, REFERENCE_M, Weighting::Relative)
}

/// Nearly normal numbers: twelve uniform ones from Knuth's MMIX generator.
struct Normal(u64);

impl Normal {
    fn next(&mut self) -> f64 {
        let mut uniform = || {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (self.0 >> 11) as f64 / (1u64 << 53) as f64
        };
        (0..12).map(|_| uniform()).sum::<f64>() - 6.0
    }
}
