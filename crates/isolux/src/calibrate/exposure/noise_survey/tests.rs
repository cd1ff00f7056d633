//! Frames of known noise: does the survey find it?

use super::*;
use crate::frame::{PixelFlags, Plane, Shape};
use crate::numerics::hash::splitmix64;

const READ_DN2: f64 = 4.0;
const SHOT_DN2_PER_DN: f64 = 0.5;

/// A frame of a ramp of amplitudes from 50 to 250 DN with the noise of the constants, whose pixels of one column
/// are alike; the intensity is twice the amplitude. `drift` scales it.
fn frame(number: u64, time_us: f64, drift: f64) -> Frame {
    let shape = Shape::new(64, 64);
    let mut state = number << 32;
    let mut normal = || {
        let mut uniform = || {
            state += 1;
            (splitmix64(state) >> 11) as f64 / (1u64 << 53) as f64
        };
        // Box and Muller. Of sums of uniforms, pairs with an outlying mean differ by less.
        (-2.0 * (1.0 - uniform()).ln()).sqrt() * (std::f64::consts::TAU * uniform()).cos()
    };
    let mean = |column: usize| time_us / 1000.0 * (50.0 + 200.0 / 63.0 * column as f64);
    let mut frame = Frame::new(shape);
    frame.amplitude = Plane::from_fn(shape, |_, column| {
        let sigma = (READ_DN2 + SHOT_DN2_PER_DN * mean(column)).sqrt();
        (drift * (mean(column) + sigma * normal())) as f32
    });
    frame.intensity = Some(Plane::from_fn(shape, |_, column| 2.0 * mean(column) as f32));
    frame.integration_time_us = IntegrationTime::PerFrame(time_us);
    frame.flag_amplitude(None);
    frame
}

fn survey(frames: &[Frame]) -> NoiseCells {
    let mut survey = NoiseSurvey::new();
    frames.iter().for_each(|frame| survey.push(frame));
    survey.finish()
}

fn expect_the_constants(found: &NoiseCells, tolerance: f64) {
    let noise = found.fit(Vec::new()).unwrap();
    for amplitude_dn in [60.0, 120.0, 240.0] {
        let truth = READ_DN2 + SHOT_DN2_PER_DN * amplitude_dn;
        let by = noise.by_amplitude;
        let by_amplitude = by.read_variance_dn2
            + by.shot_variance_dn2_per_dn * amplitude_dn
            + by.ambient_variance_dn2_per_us * 1000.0;
        let by = noise.by_intensity.unwrap();
        let by_intensity = by.read_variance_dn2 + by.shot_variance_dn2_per_dn * 2.0 * amplitude_dn;
        for found in [by_amplitude, by_intensity] {
            assert!((found / truth - 1.0).abs() < tolerance, "{amplitude_dn}: {found} {truth}");
        }
    }
}

#[test]
fn repeated_frames_tell_the_noise_whatever_the_gain_does() {
    let frames: Vec<Frame> =
        (0..12).map(|i| frame(i, 1000.0, 1.0 + 0.02 * (-(i as f64) / 4.0).exp())).collect();
    let found = survey(&frames);
    assert!(!found.spatial && found.quantization_variance_dn2 == 0.0);
    // 11·4096 differences, each frame in two: 1 % of a variance, more where four groups share them; the drift
    // leaves its scatter within a group, ±20 % of 0.5 % of 250 DN squared, 0.06 of 129.
    expect_the_constants(&found, 0.05);
}

#[test]
fn without_repeated_frames_neighbouring_pixels_do() {
    let found = survey(&[frame(1, 1000.0, 1.0), frame(2, 2000.0, 1.0)]);
    assert!(found.spatial);
    // A median deviation of 4096 overlapping differences in a few groups: 3 % of a deviation, 6 % of a variance.
    expect_the_constants(&found, 0.2);
}

#[test]
fn an_interruption_other_times_and_flagged_pixels_give_no_differences() {
    let (first, second) = (frame(1, 1000.0, 1.0), frame(2, 1000.0, 1.0));
    let mut interrupted = NoiseSurvey::new();
    interrupted.push(&first);
    interrupted.interrupt();
    interrupted.push(&second);
    assert!(interrupted.finish().spatial);
    let mut saturated = second.clone();
    saturated.flags.fill(PixelFlags::SATURATED);
    assert!(survey(&[first.clone(), saturated]).spatial);
    assert_eq!(survey(&[]).fit(Vec::new()), None);
    let mut unlike = first.clone();
    unlike.distance_m = Some(Plane::filled(Shape::new(1, 1), 1.0));
    assert!(survey(&[first, unlike]).spatial);
}

#[test]
fn whole_numbers_have_the_noise_of_their_steps() {
    let mut rounded = frame(1, 1000.0, 1.0);
    rounded.amplitude.values_mut().iter_mut().for_each(|value| *value = value.round());
    assert_eq!(survey(&[rounded]).quantization_variance_dn2, 1.0 / 12.0);
}
