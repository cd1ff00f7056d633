//! The fits equal a naive implementation of the paper, and even the decays out as well as a careful one.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "tests fail by panicking")]

mod common;

use std::collections::BTreeMap;

use common::naive_fit::{self, NaiveCubic, Weighting, paper_cubic};
use common::standardize::standardize;
use common::{builtin, calibrate, cropped, render, time_us};
use isolux::calibrate::CalibrateSettings;
use isolux::standardize::{DistanceStep, SpecularStep, TimeStep};
use isolux::terms::Cubic;
use isolux::terms::cubic::{Decay, DecayPoint};
use isolux::terms::lut::LutAnswer;
use isolux::{Calibration, Channels, Choice, Frame, Standardizer, Window};
use isolux_camera::{Scene, SimulatedFrame, Simulation};

const REFERENCE_US: f64 = 8200.0;
const REFERENCE_M: f64 = 0.75;
const CHANNELS: Channels = Channels::AMPLITUDE.union(Channels::DISTANCE).union(Channels::INTEGRATION_TIME);

/// What was promised. It is needed where the camera delivers codes: the library averages the means of frames, in
/// which unlike numbers of pixels carry the code, the naive version all pixels.
const PROMISED: f64 = 2e-3;
/// The same mean in f64 differs by the order of summation alone: fewer than 10⁵ terms of one sign, each rounded by
/// ε/2 of a sum, twice over.
const SUMMATION: f64 = 1e5 * f64::EPSILON;

#[test]
fn multipliers_equal_a_naive_implementation() {
    let mut kinect = cropped("kinect2-like", 60, 80);
    // Dead pixels that count, and a field so wide that its middle carries the code long before its corners.
    (kinect.dead_pixel_fraction, kinect.intrinsics.fx, kinect.intrinsics.fy) = (0.01, 60.0, 60.0);
    for model in [cropped("sr3100", 72, 88), cropped("o3d-like", 66, 88), kinect] {
        let name = model.name.clone();
        let tolerance = if model.saturated_amplitude.is_some() { PROMISED } else { SUMMATION };
        let mut scene = settling_wall();
        if model.saturated_amplitude.is_some() {
            // Beyond, nearly every pixel of this camera carries its code.
            scene.runs[0].integration_times_us.retain(|time| *time <= 38000.0);
        }
        let simulation = Simulation::new(model, scene, 3).unwrap();
        let frames = render(&simulation);
        let settings = CalibrateSettings { skip_frames: 2, ..CalibrateSettings::default() };
        let calibration = calibrate(&settings, &frames, &[]);
        let lut = calibration.terms.lut.as_ref().unwrap();
        let plain: Vec<_> = frames.iter().map(|simulated| &simulated.frame).collect();
        let naive = naive_fit::lut(&plain, 2, REFERENCE_US);
        let times: Vec<f64> = naive.iter().map(|(time, _)| *time).collect();
        assert_eq!(lut.integration_time_us, times, "{name}");
        for &time in &times {
            // At the samples, and half way to the next one.
            for time in [time, (1.3 * time).min(times[times.len() - 1])] {
                let LutAnswer::Inside(found) = lut.at(time) else { panic!("{name} {time}") };
                let expected = naive_fit::log_log(&naive, time);
                assert!((found / expected - 1.0).abs() < tolerance, "{name} {time}: {found} {expected}");
            }
        }
    }
}

/// A wall at 14 times, with the frames in which the camera settles.
fn settling_wall() -> Scene {
    let text = r#"
        version = 1
        name = "settling-wall"
        ambient = 0.5
        [[object]]
        name = "wall"
        form = { rectangle = { size_m = [20.0, 20.0] } }
        center_m = [0.0, 0.0, 0.9]
        texture = { uniform = 0.7 }
        [[run]]
        integration_times_us = [
            200.0, 500.0, 1000.0, 2000.0, 4000.0, 8200.0, 12000.0, 16000.0, 20000.0, 24000.0, 28000.0, 32000.0,
            38000.0, 45000.0,
        ]
        frames_per_time = 4
    "#;
    Scene::from_toml("settling-wall", text).unwrap()
}

/// The two implementations of one least-squares problem differ by rounding: condition 10⁶ of the naive normal
/// equations, 10⁻¹⁶ of f64.
#[test]
fn the_cubic_of_given_decays_equals_a_naive_implementation() {
    let curve = |d: f64| 900.0 / (d * d * (1.0 + 0.002 / (d * d)).powi(2)) * (1.0 + 0.02 * (3.3 * d).cos());
    let decay = |time: f64, from: f64, scale: f64| {
        let points = (0..14).map(move |i| from + 0.18 * f64::from(i)).map(move |d| (d, scale * curve(d)));
        (time, points.collect::<Vec<_>>())
    };
    // The last does not reach the reference.
    let decays = [decay(1000.0, 0.3, 1.0), decay(4000.0, 0.5, 3.9), decay(16000.0, 0.9, 14.0)];
    let library: Vec<_> = decays
        .iter()
        .map(|(time, points)| Decay {
            integration_time_us: Some(*time),
            points: points
                .iter()
                .map(|&(distance_m, amplitude_dn)| DecayPoint { distance_m, amplitude_dn })
                .collect(),
        })
        .collect();
    let (cubic, _) = Cubic::fit(&library, REFERENCE_M).unwrap();
    let points: Vec<_> = decays.iter().map(|(_, points)| points.clone()).collect();
    let naive = naive_fit::paper_cubic(&points, REFERENCE_M, Weighting::Relative);
    assert_eq!(cubic.valid_distance_m, naive.range_m);
    for step in 0..=50 {
        let distance = 0.3 + (naive.range_m[1] - 0.3) * f64::from(step) / 50.0;
        let found = naive_fit::polynomial(cubic.coefficients, distance) / naive.at(distance) - 1.0;
        assert!(found.abs() < 1e-9, "{distance} m: {found:e}");
    }
}

/// What a window shows over the distance: (distance, mean) of every frame whose distance is usable, by integration
/// time, from the position where the raw amplitude peaks: nearer ones are over-saturated.
type Decays = BTreeMap<u64, Vec<(f64, f64)>>;

/// Mean over the window's measured pixels of what `value` makes of (amplitude, distance).
fn window_mean(frame: &Frame, value: impl Fn(usize, f64, f64) -> f64) -> f64 {
    let distances = frame.distance_m.as_ref().unwrap().values();
    let measured = |i: &usize| frame.is_valid(*i) && distances[*i] > 0.0;
    let window = Window::centred(frame.shape(), 20);
    let pixels: Vec<usize> = window.indices(frame.shape()).filter(measured).collect();
    let values =
        pixels.iter().map(|&i| value(i, f64::from(frame.amplitude.values()[i]), f64::from(distances[i])));
    values.sum::<f64>() / pixels.len() as f64
}

fn decays(frames: &[SimulatedFrame], value: impl Fn(&Frame) -> f64) -> Decays {
    let mut decays: BTreeMap<u64, Vec<[f64; 3]>> = BTreeMap::new();
    for simulated in frames {
        let frame = &simulated.frame;
        let distance = window_mean(frame, |_, _, d| d);
        let scatter = window_mean(frame, |_, _, d| (d - distance).powi(2)).sqrt();
        if scatter < 0.1 * distance {
            let raw = window_mean(frame, |_, a, _| a);
            decays.entry(time_us(frame).to_bits()).or_default().push([distance, raw, value(frame)]);
        }
    }
    let from_peak = |points: &mut Vec<[f64; 3]>| {
        points.sort_by(|a, b| a[0].total_cmp(&b[0]));
        let largest = |a: &usize, b: &usize| points[*a][1].total_cmp(&points[*b][1]);
        let peak = (0..points.len()).max_by(largest).unwrap();
        points[peak..].iter().map(|&[distance, _, value]| (distance, value)).collect()
    };
    decays.iter_mut().map(|(&time, points)| (time, from_peak(points))).collect()
}

/// Population standard deviation over mean.
fn variation(points: &[(f64, f64)]) -> f64 {
    let count = points.len() as f64;
    let mean = points.iter().map(|(_, v)| v).sum::<f64>() / count;
    (points.iter().map(|(_, v)| (v - mean).powi(2)).sum::<f64>() / count).sqrt() / mean
}

/// CV over distance of each decay, standardized by the library and by a naive cubic.
fn variations(frames: &[SimulatedFrame], calibration: &Calibration, naive: &NaiveCubic) -> Vec<[f64; 2]> {
    let choice = Choice {
        time: Some(TimeStep::None),
        distance: Some(DistanceStep::Cubic),
        specular: Some(SpecularStep::None),
        ..Choice::default()
    };
    let standardizer = Standardizer::plan(&choice, Some(calibration), CHANNELS).unwrap();
    let ours = decays(frames, |frame| {
        let out = standardize(&standardizer, frame);
        window_mean(frame, |i, _, _| f64::from(out.amplitude.values()[i]))
    });
    let naive = decays(frames, |frame| window_mean(frame, |_, a, d| a * naive.at(d)));
    ours.values().zip(naive.values()).map(|(ours, naive)| [variation(ours), variation(naive)]).collect()
}

fn mean_of(cvs: &[[f64; 2]], which: usize) -> f64 {
    cvs.iter().map(|cv| cv[which]).sum::<f64>() / cvs.len() as f64
}

/// The paper's `polyfit(d, 1/a, 3)` weights an inverse amplitude by its size, so it is exact far away and careless
/// near by; relative weights are not. On each single decay that must show, and on all of them together. Against
/// the naive version with relative weights, the library differs in averaging the frames of a position first, which
/// splits the noisiest positions in two and gives them more weight: up to 4 % over 25 seeds, 5 % allowed.
#[test]
fn reference_decays_vary_no_more_than_under_a_careful_version_of_the_paper() {
    let frames = render(&builtin("board-distances-smoke", 1));
    let settings = CalibrateSettings::default();
    let raw: Vec<Vec<(f64, f64)>> =
        decays(&frames, |frame| window_mean(frame, |_, a, _| a)).into_values().collect();
    let pooled = calibrate(&settings, &[], &frames);
    let plain = variations(&frames, &pooled, &paper_cubic(&raw, 0.75, Weighting::Plain));
    let relative = variations(&frames, &pooled, &paper_cubic(&raw, 0.75, Weighting::Relative));
    println!("CV of each decay, pooled fit, [ours, plain]: {plain:.4?}, relative weights: {relative:.4?}");
    assert!(mean_of(&plain, 0) <= mean_of(&plain, 1), "{plain:?}");
    assert!(mean_of(&relative, 0) <= 1.05 * mean_of(&relative, 1), "{relative:?}");
    for time in [1000.0, 4200.0, 8200.0] {
        let frames: Vec<_> = frames.iter().filter(|s| time_us(&s.frame) == time).cloned().collect();
        let raw: Vec<_> = decays(&frames, |frame| window_mean(frame, |_, a, _| a)).into_values().collect();
        let own = calibrate(&settings, &[], &frames);
        let single = variations(&frames, &own, &paper_cubic(&raw, 0.75, Weighting::Plain));
        println!("CV at {time} µs, own fit, [ours, plain]: {single:.4?}");
        assert!(single[0][0] <= single[0][1], "{time} µs: {single:?}");
    }
}
