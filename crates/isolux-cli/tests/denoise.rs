//! What denoising the distance is worth, and what it may not do: on simulated frames at a signal-to-noise ratio of
//! 4.5, and through the program. `cargo test -p isolux-cli --test denoise -- --nocapture` prints the figures.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "tests fail by panicking")]

mod common;
mod support;

use common::Sandbox;
use isolux::standardize::{DenoiseStep, DistanceStep, SpecularStep, TimeStep};
use isolux::{Channels, Choice, DenoiseRule, Frame, Plane, Standardized, Standardizer};
use isolux_camera::scene::object::{Form, Object};
use isolux_camera::scene::run::Run;
use isolux_camera::scene::texture::Texture;
use isolux_camera::{CameraModel, Scene, SimulatedFrame, Simulation};

const RULES: [DenoiseRule; 4] =
    [DenoiseRule::Median, DenoiseRule::Wiener, DenoiseRule::Plane, DenoiseRule::Temporal];
/// Signal-to-noise ratio of the amplitude at which the figures are taken.
const SNR: f64 = 4.5;
/// Frames that a figure is the mean of; the temporal one needs eight before each.
const FRAMES: u32 = 24;

/// An SR-3100 without profile, decay by angle, wiggling, drift and dead pixels: the noise alone is left.
fn camera() -> CameraModel {
    CameraModel {
        lobe_exponent: 0.0,
        lens_exponent: 0.0,
        third_harmonic: 0.0,
        warm_up_amplitude: 0.0,
        dead_pixel_fraction: 0.0,
        ..CameraModel::preset("sr3100").unwrap()
    }
}

fn record(objects: Vec<Object>, time_us: f64, frames: u32) -> Vec<SimulatedFrame> {
    let run = Run { integration_times_us: vec![time_us], frames_per_time: frames, ..Run::default() };
    let scene = Scene {
        version: 1,
        name: "test".to_owned(),
        description: String::new(),
        camera: "sr3100".to_owned(),
        ambient: 0.5,
        objects,
        runs: vec![run],
    };
    support::render(&Simulation::new(camera(), scene, 5).unwrap())
}

/// Frames whose amplitude has the wanted signal-to-noise ratio in the pixels that `counts` (by row and column).
fn at_snr(objects: &[Object], counts: impl Fn(usize, usize) -> bool) -> Vec<SimulatedFrame> {
    let snr = |time_us: f64| {
        let frames = record(objects.to_vec(), time_us, 2);
        let [a, b] = [0, 1].map(|i| counted(&frames[i].frame.amplitude, &counts));
        let differences: Vec<f64> = a.iter().zip(&b).map(|(a, b)| a - b).collect();
        mean(&a) / (deviation(&differences) / 2f64.sqrt())
    };
    let (mut low, mut high) = (1.0, 60_000.0f64);
    for _ in 0..20 {
        let middle = (low * high).sqrt();
        if snr(middle) < SNR { low = middle } else { high = middle }
    }
    record(objects.to_vec(), high, FRAMES)
}

fn counted(plane: &Plane<f32>, counts: impl Fn(usize, usize) -> bool) -> Vec<f64> {
    let width = plane.shape().width;
    let values = plane.values().iter().enumerate();
    values.filter(|(i, v)| !v.is_nan() && counts(i / width, i % width)).map(|(_, v)| f64::from(*v)).collect()
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

fn deviation(values: &[f64]) -> f64 {
    let mean = mean(values);
    (values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / values.len() as f64).sqrt()
}

fn standardizer(rule: Option<DenoiseRule>) -> Standardizer {
    let choice = Choice {
        time: Some(TimeStep::None),
        denoise: rule.map(DenoiseStep::Smooth),
        distance: Some(DistanceStep::Square),
        specular: Some(SpecularStep::None),
        ..Choice::default()
    };
    Standardizer::plan(&choice, None, Channels::AMPLITUDE | Channels::DISTANCE).unwrap()
}

/// The frames scaled by d²; with temporal denoising those with a full history alone.
fn scaled(frames: &[SimulatedFrame], rule: Option<DenoiseRule>) -> Vec<Plane<f32>> {
    let standardizer = standardizer(rule);
    let mut history = standardizer.history();
    let mut smoothed = Plane::filled(frames[0].frame.shape(), f32::NAN);
    let mut out = Standardized::new(frames[0].frame.shape());
    let one = |SimulatedFrame { frame, .. }: &SimulatedFrame| {
        match &mut history {
            Some(history) => {
                history.push(frame, &mut smoothed).unwrap();
                standardizer.apply_at(frame, &smoothed, &mut out).unwrap()
            }
            None => standardizer.apply(frame, &mut out).unwrap(),
        };
        out.amplitude.clone()
    };
    let all: Vec<_> = frames.iter().map(one).collect();
    if rule == Some(DenoiseRule::Temporal) { all[7..].to_vec() } else { all }
}

/// The same with the true distance.
fn perfect(frames: &[SimulatedFrame]) -> Vec<Plane<f32>> {
    let standardizer = standardizer(None);
    let mut out = Standardized::new(frames[0].frame.shape());
    let one = |simulated: &SimulatedFrame| {
        standardizer.apply_at(&simulated.frame, &simulated.truth.true_distance_m, &mut out).unwrap();
        out.amplitude.clone()
    };
    frames.iter().map(one).collect()
}

fn mean_of(planes: &[Plane<f32>], counts: impl Fn(usize, usize) -> bool + Copy) -> f64 {
    mean(&planes.iter().map(|plane| mean(&counted(plane, counts))).collect::<Vec<_>>())
}

fn inner(row: usize, column: usize) -> bool {
    (12..132).contains(&row) && (12..164).contains(&column)
}

fn wall(depth_m: f64, texture: Texture) -> Object {
    Object::new("wall", Form::Rectangle { size_m: [100.0, 100.0] }, [0.0, 0.0, depth_m], texture)
}

/// A ball around the camera: the same distance everywhere.
fn surrounding(texture: Texture) -> Object {
    Object::new("ball", Form::Sphere { radius_m: 2.45 }, [0.0; 3], texture)
}

/// Noise of A′ against that with the true distance, 1 + (2/φ)² in the square of it without denoising. The methods'
/// prototypes: median 1.08, wiener 1.036, plane 1.014, temporal 1.07. The mean of 8 leaves (2/φ)²/8 of the square.
#[test]
fn noise_on_flat_areas_is_near_that_of_a_perfect_distance() {
    let frames = at_snr(&[surrounding(Texture::Uniform(0.5))], inner);
    let noise = |planes: &[Plane<f32>]| {
        mean(
            &planes
                .iter()
                .map(|p| {
                    let v = counted(p, inner);
                    deviation(&v) / mean(&v)
                })
                .collect::<Vec<_>>(),
        )
    };
    let floor = noise(&perfect(&frames));
    let ratio = |rule| noise(&scaled(&frames, rule)) / floor;
    println!("noise of A' on flat areas: perfect {floor:.4}, none {:.3} times that", ratio(None));
    for rule in RULES {
        println!("  {:>8} {:.3}", rule.name(), ratio(Some(rule)));
    }
    assert!(ratio(None) > 1.3);
    assert!(ratio(Some(DenoiseRule::Wiener)) <= 1.05);
    assert!(ratio(Some(DenoiseRule::Plane)) <= 1.05);
    assert!(ratio(Some(DenoiseRule::Median)) <= 1.12);
    assert!(ratio(Some(DenoiseRule::Temporal)) <= 1.12);
}

/// Bars of 3 pixels before a wall: the mean of A′ on them against that with the true distance.
#[test]
fn three_pixel_bars_keep_their_distance() {
    for wall_m in [2.75, 3.0, 3.25, 3.5, 4.0, 4.45] {
        let bar_m = 2.45;
        let pixel_m = bar_m / camera().intrinsics.fx;
        let mut objects = vec![wall(wall_m, Texture::Uniform(0.5))];
        // Edges of the columns 20..23, 36..39 … in metres.
        let lefts: Vec<usize> = (20..156).step_by(16).collect();
        for &left in &lefts {
            let x = (left as f64 + 1.0 - camera().intrinsics.cx) * pixel_m;
            let form = Form::Rectangle { size_m: [3.0 * pixel_m, 100.0] };
            objects.push(Object::new(&format!("bar {left}"), form, [x, 0.0, bar_m], Texture::Uniform(0.5)));
        }
        let on_bar = |row: usize, column: usize| {
            inner(row, column) && column >= 20 && (column - 20) % 16 < 3 && column < 156
        };
        let frames = at_snr(&objects, on_bar);
        let truth = mean_of(&perfect(&frames), on_bar);
        let bias = |rule| mean_of(&scaled(&frames, rule), on_bar) / truth - 1.0;
        println!(
            "bias of A' on 3-pixel bars {:.2} m before a wall: none {:+.2} %",
            wall_m - bar_m,
            100.0 * bias(None)
        );
        for rule in RULES {
            println!("  {:>8} {:+.2} %", rule.name(), 100.0 * bias(Some(rule)));
        }
    }
}
