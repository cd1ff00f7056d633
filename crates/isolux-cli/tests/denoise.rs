//! What denoising the distance is worth, and what it may not do: on simulated frames at a signal-to-noise ratio of
//! 4.5, and through the program. `cargo test -p isolux-cli --test denoise -- --nocapture` prints the figures.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "tests fail by panicking")]

mod common;
mod support;

use common::Sandbox;
use isolux::standardize::{DenoiseStep, DistanceStep, SpecularStep, TimeStep};
use isolux::{Channels, Choice, DenoiseRule, Plane, Standardized, Standardizer};
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

/// Bars of 3 pixels, 16 apart, before a wall that returns the same amplitude (which the bars' contours are not to be
/// seen by) or is of the same material. `wall_m` is the wall's depth.
fn bars(wall_m: f64, alike: bool) -> (Vec<SimulatedFrame>, impl Fn(usize, usize) -> bool + Copy) {
    const BAR_M: f64 = 2.45;
    let (fx, cx) = (camera().intrinsics.fx, camera().intrinsics.cx);
    let reflectivity = if alike { 0.9 * (BAR_M / wall_m).powi(2) } else { 0.9 };
    let bar = |left: usize| {
        let x = (left as f64 + 1.0 - cx) * BAR_M / fx;
        let form = Form::Rectangle { size_m: [3.0 * BAR_M / fx, 100.0] };
        Object::new(&format!("bar {left}"), form, [x, 0.0, BAR_M], Texture::Uniform(reflectivity))
    };
    let mut objects = vec![wall(wall_m, Texture::Uniform(0.9))];
    objects.extend((20..156).step_by(16).map(bar));
    let on_bar = |row, column| inner(row, column) && (20..156).contains(&column) && (column - 20) % 16 < 3;
    (at_snr(&objects, on_bar), on_bar)
}

/// The mean of A′ on the bars against that with the true distance: at most 5 %, from steps on that stand out of the
/// noise of one pixel (σ_d = 0.27 m) in one way or the other.
#[test]
fn three_pixel_bars_keep_their_distance() {
    for (wall_m, alike) in
        [(2.75, true), (3.25, true), (3.75, true), (4.45, true), (5.45, true), (3.25, false), (4.45, false)]
    {
        let (frames, on_bar) = bars(wall_m, alike);
        let truth = mean_of(&perfect(&frames), on_bar);
        let bias = |rule| mean_of(&scaled(&frames, rule), on_bar) / truth - 1.0;
        let amplitude = if alike { "equal amplitude" } else { "equal material" };
        print!(
            "bias on bars {:.1} m before a wall, {amplitude}: none {:+.2} %",
            wall_m - 2.45,
            100.0 * bias(None)
        );
        for rule in RULES {
            print!(", {} {:+.2} %", rule.name(), 100.0 * bias(Some(rule)));
        }
        println!();
        if wall_m >= 3.75 {
            assert!(bias(Some(DenoiseRule::Wiener)).abs() <= 0.05);
            assert!(bias(Some(DenoiseRule::Plane)).abs() <= 0.05);
        }
        assert!(bias(Some(DenoiseRule::Temporal)).abs() <= 0.01);
    }
}

/// The distance that scaled a pixel.
fn used_distance(simulated: &SimulatedFrame, scaled: &Plane<f32>) -> Plane<f32> {
    let used = |row, column| {
        let [scaled, raw] = [scaled, &simulated.frame.amplitude].map(|plane| plane.get(row, column).unwrap());
        0.75 * (scaled / raw).sqrt()
    };
    Plane::from_fn(scaled.shape(), used)
}

/// Mean departure of the used distance from the true one in the pixels that count, m.
fn distance_bias(
    frames: &[SimulatedFrame],
    rule: DenoiseRule,
    counts: impl Fn(usize, usize) -> bool + Copy,
) -> f64 {
    let planes = scaled(frames, Some(rule));
    let frames = &frames[frames.len() - planes.len()..];
    let one = |(simulated, scaled): (&SimulatedFrame, &Plane<f32>)| {
        mean(&counted(&used_distance(simulated, scaled), counts))
            - mean(&counted(&simulated.truth.true_distance_m, counts))
    };
    mean(&frames.iter().zip(&planes).map(one).collect::<Vec<_>>())
}

/// A checkerboard at one distance: the bright and the dark squares keep it. The two means of 8000 pixels and 17 frames
/// or more at σ_d = 0.3 m differ by 0.3 √(2/136 000) = 1.2 mm; smoothing may pass what one square has to the other,
/// never add to it. Four of these.
#[test]
fn the_amplitudes_texture_does_not_leak_into_the_distance() {
    let texture = Texture::Checkerboard { cell_m: 0.1, reflectivities: [0.5, 0.9] };
    let frames = at_snr(&[surrounding(texture)], inner);
    let reflectivity = frames[0].truth.reflectivity.clone();
    let bright = |row, column| inner(row, column) && reflectivity.get(row, column).unwrap() > 0.7;
    let dark = |row, column| inner(row, column) && reflectivity.get(row, column).unwrap() <= 0.7;
    for rule in RULES {
        let leak = distance_bias(&frames, rule, bright) - distance_bias(&frames, rule, dark);
        println!("checkerboard, {}: bright less dark squares {:+.2} mm", rule.name(), 1000.0 * leak);
        assert!(leak.abs() <= 0.005, "{rule:?} {leak}");
    }
}

/// A wall turned by 50° with a checkerboard on it, and a ball: no systematic departure beyond 0.5 % of the distance.
#[test]
fn slanted_and_round_surfaces_keep_their_distance() {
    let texture = Texture::Checkerboard { cell_m: 0.1, reflectivities: [0.5, 0.9] };
    let mut slant = wall(2.45, texture);
    slant.yaw_deg = 50.0;
    let ball = Object::new("ball", Form::Sphere { radius_m: 0.8 }, [0.0, 0.0, 3.0], Texture::Uniform(0.9));
    let middle = |row: usize, column: usize| (42..102).contains(&row) && (58..118).contains(&column);
    for (name, object) in [("slant", slant), ("ball", ball)] {
        let frames = at_snr(&[object], middle);
        for rule in RULES {
            let bias = distance_bias(&frames, rule, middle);
            println!("{name}, {}: {:+.2} mm", rule.name(), 1000.0 * bias);
            assert!(bias.abs() <= 0.005 * 2.2, "{name} {rule:?} {bias}");
        }
    }
}

/// Through the program: recorded among the steps, the same bits with any number of threads, the input kept.
#[test]
fn the_program_denoises_alike_with_any_number_of_threads() {
    let sandbox = Sandbox::new();
    let done = |arguments: &str| {
        let run = sandbox.run(arguments);
        assert_eq!(run.code, Some(0), "{arguments}: {}", run.stderr);
        run.stdout
    };
    done("simulate patches-smoke -o rec");
    done("standardize rec -o plain");
    let plain = sandbox.f32s("plain/standardized_amplitude.npy");
    for rule in RULES.map(DenoiseRule::name) {
        done(&format!("standardize rec -o {rule}1 --threads 1 --denoise {rule}"));
        done(&format!("standardize rec -o {rule}3 --threads 3 --denoise {rule} --keep-input"));
        let [one, three] = [1, 3].map(|n| sandbox.array(&format!("{rule}{n}/standardized_amplitude.npy")));
        assert_eq!(one, three, "{rule}");
        assert_eq!(sandbox.array(&format!("{rule}3/distance.npy")), sandbox.array("rec/distance.npy"));
        let found = sandbox.f32s(&format!("{rule}1/standardized_amplitude.npy"));
        assert!(found.iter().zip(&plain).all(|(found, plain)| found.is_nan() == plain.is_nan()), "{rule}");
        assert_ne!(found, plain, "{rule}");
        let record = sandbox.json(&format!("{rule}1/recording.json"));
        let steps = record["standardization"]["steps"].as_array().unwrap();
        let effects: Vec<_> = steps.iter().map(|step| step["effect"].as_str().unwrap()).collect();
        assert_eq!(effects, ["time", "denoise", "distance", "specular"]);
        assert_eq!(steps[1]["term"], rule);
        done(&format!("evaluate rec --denoise {rule}"));
    }
    done("standardize rec -o none --denoise none");
    assert_eq!(
        sandbox.array("none/standardized_amplitude.npy"),
        sandbox.array("plain/standardized_amplitude.npy")
    );
    assert!(
        sandbox
            .run("standardize rec -o idle --denoise wiener --distance none")
            .stderr
            .contains("nothing to denoise")
    );
}

/// What counts as outside the calibrated distances is decided by the denoised distance.
#[test]
fn the_range_is_that_of_the_denoised_distance() {
    use isolux::{Frame, PixelFlags, Shape};
    let shape = Shape::new(9, 9);
    let choice = Choice {
        denoise: Some(DenoiseStep::Smooth(DenoiseRule::Median)),
        time: Some(TimeStep::None),
        ..Choice::default()
    };
    let channels = Channels::AMPLITUDE | Channels::DISTANCE;
    let calibration = support::strategies::calibration();
    let mut frame = Frame::new(shape);
    frame.amplitude.fill(100.0);
    // One pixel beyond the calibrated 3 m.
    frame.distance_m =
        Some(Plane::from_fn(shape, |row, column| if (row, column) == (4, 4) { 3.5 } else { 2.0 }));
    let outside = |choice| {
        let mut out = Standardized::new(shape);
        let standardizer = Standardizer::plan(&choice, Some(&calibration), channels).unwrap();
        let summary = standardizer.apply(&frame, &mut out).unwrap();
        assert_eq!(
            summary.distance_extrapolated > 0,
            out.flags.get(4, 4).unwrap().contains(PixelFlags::DISTANCE_OUT_OF_RANGE)
        );
        summary.distance_extrapolated
    };
    assert_eq!(outside(Choice { denoise: None, ..choice }), 1);
    assert_eq!(outside(choice), 0);
}
