//! A target before a camera that is known exactly: does the fit find it, and does the inverse undo it?

use super::light::Light;
use super::model::phase;
use super::*;
use crate::numerics::hash::splitmix64;
use crate::terms::spline::Law;
use crate::terms::{FitQuality, Source};

const FREQUENCY_HZ: f64 = 20e6;
/// Relative error of each amplitude of the sweep.
const AMPLITUDE_NOISE: f64 = 0.001;

/// W/c0 of 1600 DN, ambient light of half the target's own charge at the reference.
fn truth() -> AmbientResponse {
    AmbientResponse {
        full_well_dn: 3200.0,
        softness: 5.0,
        clip: 0.95,
        own_charge: 2.0,
        ambient_dn_per_us: 0.12,
        target_dn_per_us: 0.12,
        law: Law {
            reference_distance_m: 0.75,
            valid_distance_m: [0.3, 3.0],
            coefficients: vec![0.0; 13],
            harmonic: None,
            curvature_weight: 0.0,
        },
        modulation_frequency_hz: Some(FREQUENCY_HZ),
        noise: Some(AmbientNoise { read_variance_dn2: 2.0, shot_variance_dn2_per_dn: 0.05 }),
        fitted_on: Vec::<Source>::new(),
        fit: FitQuality { points: 0, residual: 0.0, held_out_residual: None },
    }
}

fn normal(seed: u64) -> f64 {
    let uniform = |seed: u64| (splitmix64(seed) >> 11) as f64 / (1u64 << 53) as f64;
    (-2.0 * (1.0 - uniform(2 * seed)).ln()).sqrt() * (std::f64::consts::TAU * uniform(2 * seed + 1)).cos()
}

fn light(camera: &AmbientResponse, distance_m: f64, time_us: f64, reflectivity: f64, ambient: f64) -> Light {
    Light {
        amplitude_dn: reflectivity * time_us * camera.target_at(distance_m),
        charge: camera.charge(distance_m, ambient),
        phase: phase(camera.modulation_frequency_hz, distance_m),
    }
}

/// The sweep: for each time, the positions from the brightest on.
fn sweep(camera: &AmbientResponse, longest_us: f64) -> Vec<TargetSample> {
    let mut samples = Vec::new();
    for time_us in [0.1, 0.25, 0.5, 1.0].map(|share| share * longest_us) {
        let place = |i: u32| 0.3 * 10f64.powf(f64::from(i) / 24.0);
        let amplitude =
            |d: f64| camera.well().amplitude_dn(light(camera, d, time_us, 1.0, camera.ambient_dn_per_us));
        let brightest = (0..=24).max_by(|a, b| amplitude(place(*a)).total_cmp(&amplitude(place(*b))));
        for i in brightest.unwrap_or(0)..=24 {
            let seed = samples.len() as u64 + 1;
            let here = light(camera, place(i), time_us, 1.0, camera.ambient_dn_per_us);
            let noise = camera.noise.unwrap();
            let variance_dn2 =
                camera.well().variance_dn2(here, noise.read_variance_dn2, noise.shot_variance_dn2_per_dn);
            samples.push(TargetSample {
                integration_time_us: time_us,
                distance_m: place(i),
                amplitude_dn: amplitude(place(i)) * (1.0 + AMPLITUDE_NOISE * normal(seed)),
                relative_error: AMPLITUDE_NOISE,
                noise: Some(NoiseOfSample {
                    variance_dn2: variance_dn2 * (1.0 + 0.03 * normal(seed + 1000)),
                    differences: 2000.0,
                }),
            });
        }
    }
    samples
}

fn fit(samples: Vec<TargetSample>) -> Result<AmbientResponse, AmbientError> {
    AmbientResponse::fit(&[samples], 0.75, Some(FREQUENCY_HZ), Vec::new())
}

#[test]
fn the_fit_finds_what_amplitudes_determine() {
    let camera = truth();
    let found = fit(sweep(&camera, 16_000.0)).unwrap();
    let ratio = found.full_well_dn / found.own_charge / (camera.full_well_dn / camera.own_charge);
    // About a hundred amplitudes of 0.1 % and one free law: the well follows to a percent or two.
    assert!((ratio - 1.0).abs() < 0.02, "{ratio}");
    let share = |r: &AmbientResponse| r.ambient_dn_per_us / (r.own_charge * r.target_dn_per_us);
    assert!((share(&found) / share(&camera) - 1.0).abs() < 0.1, "{} {}", share(&found), share(&camera));
    assert!(found.fit.residual < 2.5 * AMPLITUDE_NOISE, "{:?}", found.fit);
    // What is corrected: amplitudes of surfaces of all reflectivities that do not saturate.
    for distance_m in [0.4, 0.75, 1.5, 2.8] {
        for reflectivity in [0.1, 0.5, 1.0] {
            let here = light(&camera, distance_m, 6000.0, reflectivity, camera.ambient_dn_per_us);
            if here.amplitude_dn > 0.9 * camera.well().peak_dn(here.charge, here.phase) {
                continue;
            }
            let delivered = camera.well().amplitude_dn(here);
            let linear = found.linear_of_sweep_dn(delivered, distance_m).unwrap();
            let gain =
                linear / found.target_at(distance_m) / (here.amplitude_dn / camera.target_at(distance_m));
            assert!((gain - 1.0).abs() < 0.01, "{distance_m} {reflectivity}: {gain}");
        }
    }
}

#[test]
fn what_the_sweep_does_not_determine_is_said() {
    let camera = truth();
    assert!(matches!(fit(sweep(&camera, 300.0)), Err(AmbientError::NoCompression { .. })));
    let one_time: Vec<TargetSample> =
        sweep(&camera, 16_000.0).into_iter().filter(|s| s.integration_time_us == 1600.0).collect();
    assert_eq!(fit(one_time), Err(AmbientError::OneTime));
    assert!(matches!(fit(Vec::new()), Err(AmbientError::TooFewSamples { found: 0, .. })));
    let far = sweep(&camera, 16_000.0).into_iter().filter(|s| s.distance_m > 1.0).collect();
    assert!(matches!(fit(far), Err(AmbientError::ReferenceOutside { .. })));
    let mut disturbed = sweep(&camera, 16_000.0);
    disturbed.iter_mut().step_by(2).for_each(|sample| sample.amplitude_dn *= 1.3);
    assert!(matches!(fit(disturbed), Err(AmbientError::Misfit { .. })));
}

#[test]
fn the_tables_equal_the_exact_inverse() {
    let camera = truth();
    let planned = camera.planned();
    let mut compared = 0;
    for step in 0..2000u32 {
        let distance_m = 0.35 + 2.5 * f64::from(step) / 2000.0;
        let reflectivity = 0.05 + 1.1 * f64::from(step % 17) / 17.0;
        let time_us = 300.0 * 1.5f64.powi((step % 7) as i32);
        let ambient = 0.12 * f64::from(step % 4);
        let here = light(&camera, distance_m, time_us, reflectivity, ambient);
        let delivered = camera.well().amplitude_dn(here);
        let found = planned.linearise(delivered as f32, distance_m as f32, time_us as f32, ambient as f32);
        let peak = camera.well().peak_dn(here.charge, here.phase);
        if let Some(Recovered::Linear(linear)) = found {
            // Interpolation over charge and ripple: (1/8)²/8 of a second difference below 0.1, near the peak.
            let error = f64::from(linear) / here.amplitude_dn - 1.0;
            assert!(error.abs() < 3e-3 && here.amplitude_dn < peak, "{step}: {error} {here:?}");
            compared += 1;
        }
    }
    assert!(compared > 1000, "{compared}");
}

#[test]
fn a_pixel_on_the_falling_branch_is_never_given_a_value() {
    let camera = truth();
    let planned = camera.planned();
    for step in 0..400u32 {
        let distance_m = 0.32 + 0.002 * f64::from(step);
        let here = light(&camera, distance_m, 12_000.0, 1.15, camera.ambient_dn_per_us);
        let peak = camera.well().peak_dn(here.charge, here.phase);
        if here.amplitude_dn < 1.02 * peak {
            continue;
        }
        let delivered = camera.well().amplitude_dn(here) as f32;
        let found =
            planned.linearise(delivered, distance_m as f32, 12_000.0, camera.ambient_dn_per_us as f32);
        // Where all bins clip, there is no amplitude at all.
        let fine = matches!(found, Some(Recovered::Ambiguous | Recovered::Saturated)) || delivered < 1.0;
        assert!(fine, "{distance_m}: {found:?}");
    }
}

#[test]
fn no_distance_no_answer() {
    let planned = truth().planned();
    for (amplitude, distance_m, time_us) in
        [(100.0, 0.0, 1000.0), (100.0, f32::NAN, 1000.0), (f32::NAN, 1.0, 1000.0), (100.0, 1.0, 0.0)]
    {
        assert_eq!(planned.linearise(amplitude, distance_m, time_us, 0.1), None);
    }
}
