//! The spline over distance: what it is of the simulated camera's true law, what it leaves of the paper's protocol on
//! frames and cameras that it was not made on, and how a chain uses it. The figures of the protocol:
//! `cargo test --release -p isolux --test spline -- --nocapture the_order`.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "tests fail by panicking")]

mod common;

use isolux::calibrate::{self, CalibrateSettings, DistanceSweep};
use isolux::standardize::{DistanceStep, SpecularStep, TimeStep};
use isolux::terms::cubic::Decay;
use isolux::terms::{Cubic, Spline};
use isolux::{Calibration, Channels, Choice, Frame, PixelFlags, Plane, Shape, Standardizer};
use isolux_camera::{CameraModel, Scene, Simulation};

const REFERENCE_M: f64 = 0.75;

/// Around the principal point, as large as the measurement needs.
fn small(mut model: CameraModel) -> CameraModel {
    (model.height, model.width) = (40, 40);
    (model.intrinsics.cy, model.intrinsics.cx) = (19.5, 19.5);
    model
}

/// The same camera, linear: what a perfect linearization would leave to the law over distance.
fn linear(mut model: CameraModel) -> CameraModel {
    model.full_well_electrons *= 250.0;
    model.gain_dn_per_electron *= 0.1;
    model
}

/// The paper's protocol: the reference decays that a calibration makes of the built-in scene.
fn decays(model: &CameraModel, seed: u64) -> Vec<Decay> {
    let simulation =
        Simulation::new(model.clone(), Scene::builtin("board-distances").unwrap(), seed).unwrap();
    let mut sweep = DistanceSweep::new("board", &CalibrateSettings::default());
    common::render(&simulation).iter().for_each(|simulated| sweep.push(&simulated.frame).unwrap());
    sweep.finish().decays
}

type Law<'a> = Box<dyn Fn(f64) -> f64 + 'a>;

/// Standard deviation of the logarithm of the standardized decays around the mean of each: all positions of at
/// least `beyond` times the nearest distance of their decay.
fn variation(decays: &[Decay], law: &Law, beyond: f64) -> f64 {
    let (mut squares, mut count) = (0.0, 0.0);
    for decay in decays {
        let nearest = decay.points.iter().map(|p| p.distance_m).fold(f64::INFINITY, f64::min);
        let logs: Vec<f64> = (decay.points.iter())
            .filter(|p| p.distance_m >= beyond * nearest)
            .map(|p| (p.amplitude_dn * law(p.distance_m)).ln())
            .collect();
        let mean = logs.iter().sum::<f64>() / logs.len() as f64;
        squares += logs.iter().map(|log| (log - mean).powi(2)).sum::<f64>();
        count += logs.len() as f64;
    }
    (squares / count).sqrt()
}

const NAMES: [&str; 5] = ["eq. 5", "d²", "cubic", "spline", "spline + cos 4φ"];

/// The laws in the order of [`NAMES`], fitted on one sweep.
fn laws(model: &CameraModel, decays: &[Decay]) -> [Law<'static>; 5] {
    let cubic = Cubic::fit(decays, REFERENCE_M).unwrap().0.distance_law();
    let spline = Spline::fit(decays, REFERENCE_M, None).unwrap().0;
    let harmonic = Spline::fit(decays, REFERENCE_M, Some(model.modulation_frequency_hz)).unwrap().0;
    [
        Box::new(|d| 4.0 * d * d + 1.0),
        Box::new(|d| d * d),
        Box::new(move |d| f64::from(cubic.at(d as f32))),
        Box::new(move |d| spline.multiplier(d)),
        Box::new(move |d| harmonic.multiplier(d)),
    ]
}

/// Figures of one camera: fitted on the noise of seed 1, tested on that of seed 2.
fn held_out(model: &CameraModel, beyond: f64) -> [f64; 5] {
    let (fitted, tested) = (decays(model, 1), decays(model, 2));
    laws(model, &fitted).map(|law| variation(&tested, &law, beyond))
}

#[test]
fn the_order_of_the_laws_holds_on_held_out_frames_and_cameras() {
    println!("| camera | positions | {} |", NAMES.join(" | "));
    let mut cameras = vec![small(CameraModel::preset("sr3100").unwrap())];
    cameras.extend((1..=6).map(|seed| small(CameraModel::random(seed))));
    let mut sums = [[0.0; 5]; 3];
    for model in &cameras {
        let cases = [
            ("all", model.clone(), 0.0),
            ("from 1.5×", model.clone(), 1.5),
            ("linear", linear(model.clone()), 0.0),
        ];
        for ((positions, model, beyond), sum) in cases.iter().zip(&mut sums) {
            let figures = held_out(model, *beyond);
            sum.iter_mut().zip(figures).for_each(|(sum, figure)| *sum += figure * figure);
            let cells = figures.map(|figure| format!("{:.2} %", 100.0 * figure)).join(" | ");
            println!("| {} | {positions} | {cells} |", model.name);
        }
    }
    let mean = sums.map(|sum| sum.map(|sum| (sum / cameras.len() as f64).sqrt()));
    for (positions, figures) in ["all", "from 1.5×", "linear"].iter().zip(mean) {
        let cells = figures.map(|figure| format!("{:.2} %", 100.0 * figure)).join(" | ");
        println!("| root mean square | {positions} | {cells} |");
    }
    let [all, unsaturated, linear] = mean;
    // Where the camera is linear, a spline is better than a cubic, and that is no worse than d².
    for [eq5, square, cubic, spline, harmonic] in [unsaturated, linear] {
        assert!(harmonic < 1.05 * spline && spline < 0.85 * cubic && cubic <= 1.02 * square && square < eq5);
    }
    assert!(unsaturated[3] < 0.5 * unsaturated[2], "{unsaturated:?}");
    // Among all positions, those that saturation compresses decide. A cubic bends towards them, and errs elsewhere;
    // the spline takes them for outliers. Neither can be right: one law cannot, for times that saturate differently.
    let [eq5, square, cubic, spline, _] = all;
    assert!(spline < 1.1 * cubic && spline < square && square < eq5, "{all:?}");
}

/// The bound: noise theory of a window's mean at the dimmest position, times five standard errors, as the leverage
/// of a position on a curve is at most 1; and what smoothing may leave, which cross-validation weighs against noise.
#[test]
fn the_spline_is_the_cameras_true_law_within_noise() {
    const SMOOTHING: f64 = 2e-3;
    let mut model = small(CameraModel::preset("sr3100").unwrap());
    (model.full_well_electrons, model.gain_dn_per_electron) = (1e8, 0.015);
    (model.warm_up_amplitude, model.dead_pixel_fraction) = (0.0, 0.0);
    let mut scene = Scene::builtin("board-distances").unwrap();
    scene.runs[0].integration_times_us.retain(|time| *time > 4000.0);
    let simulation = Simulation::new(model.clone(), scene, 11).unwrap();
    let frames = common::render(&simulation);
    let mut sweep = DistanceSweep::new("board", &CalibrateSettings::default());
    frames.iter().for_each(|simulated| sweep.push(&simulated.frame).unwrap());
    let (spline, _) =
        Spline::fit(&sweep.finish().decays, REFERENCE_M, Some(model.modulation_frequency_hz)).unwrap();
    let noise = |simulated: &isolux_camera::SimulatedFrame| {
        let index = 20 * 40 + 20;
        let electrons =
            f64::from(simulated.truth.noise_free_amplitude.values()[index]) / model.gain_dn_per_electron;
        let relative =
            model.bin_noise_electrons(electrons / model.modulation_contrast) / 2f64.sqrt() / electrons;
        let distance_m = f64::from(simulated.truth.true_distance_m.values()[index]);
        let distance = relative * model.ambiguity_range_m() / std::f64::consts::TAU / distance_m;
        // 20×20 pixels, three frames; ln(A d²) has twice the relative error of d.
        relative.hypot(2.0 * distance) / 1200f64.sqrt()
    };
    let dimmest = frames.iter().map(noise).fold(0.0, f64::max);
    let [min, max] = spline.law.valid_distance_m;
    let error = |step: u32| {
        let d = min * (max / min).powf(f64::from(step) / 200.0);
        (spline.ln_response(d) - model.distance_response(d, REFERENCE_M).ln()).abs()
    };
    let largest = (0..=200).map(error).fold(0.0, f64::max);
    println!(
        "largest error {largest:.2e}, noise of the dimmest mean {dimmest:.2e}, {:?}",
        spline.law.harmonic
    );
    assert!(largest < 5.0 * dimmest + SMOOTHING, "{largest:e} {dimmest:e}");
    assert!(5.0 * dimmest < 1.5e-2, "the proof is sharp: {dimmest:e}");
}

/// A calibration whose spline covers 0.35 to 3 m.
fn calibration() -> Calibration {
    let decays = decays(&small(CameraModel::preset("sr3100").unwrap()), 1);
    let mut calibration = Calibration::new(None, isolux::Reference::default());
    calibration.terms.spline = Some(Spline::fit(&decays, REFERENCE_M, Some(20e6)).unwrap().0);
    calibration.terms.cubic = Some(Cubic::fit(&decays, REFERENCE_M).unwrap().0);
    calibration
}

/// Every pixel against the law in f64: the table's 1e-5, the flag exactly outside the range, the slope of d² there.
#[test]
fn every_pixel_is_scaled_by_the_law_and_flagged_outside_its_range() {
    let calibration = calibration();
    let spline = calibration.terms.spline.as_ref().unwrap();
    let shape = Shape::new(50, 70);
    let mut frame = Frame::new(shape);
    frame.amplitude = Plane::filled(shape, 100.0);
    let distances = Plane::from_fn(shape, |row, column| 0.05 * 1.002_f32.powi((row * 70 + column) as i32));
    frame.distance_m = Some(distances.clone());
    frame.flag_amplitude(None);
    let choice = Choice {
        time: Some(TimeStep::None),
        distance: Some(DistanceStep::Spline),
        specular: Some(SpecularStep::None),
        ..Choice::default()
    };
    let channels = Channels::AMPLITUDE | Channels::DISTANCE;
    let standardizer = Standardizer::plan(&choice, Some(&calibration), channels).unwrap();
    let out = common::standardize::standardize(&standardizer, &frame);
    let [min_m, max_m] = spline.law.valid_distance_m.map(|end| end as f32);
    let (mut inside, mut outside) = (0, 0);
    for (index, &d) in distances.values().iter().enumerate() {
        let expected = 100.0 * spline.multiplier(f64::from(d));
        assert!((f64::from(out.amplitude.values()[index]) / expected - 1.0).abs() < 1e-5, "{d} m");
        let flagged = out.flags.values()[index].contains(PixelFlags::DISTANCE_OUT_OF_RANGE);
        assert_eq!(flagged, d < min_m || d > max_m, "{d} m");
        *(if flagged { &mut outside } else { &mut inside }) += 1;
    }
    assert!(inside > 800 && outside > 800, "{inside} {outside}");
}

#[test]
fn best_prefers_the_spline_and_paper_the_cubic() {
    let calibration = calibration();
    let channels = Channels::AMPLITUDE | Channels::DISTANCE;
    let term = |choice: &Choice, calibration: &Calibration| {
        let standardizer = Standardizer::plan(choice, Some(calibration), channels).unwrap();
        standardizer.steps().iter().find(|step| step.effect == "distance").unwrap().term
    };
    assert_eq!(term(&Choice::default(), &calibration), "spline");
    let mut without = calibration.clone();
    without.terms.spline = None;
    assert_eq!(term(&Choice::default(), &without), "cubic");
    let named = Choice { distance: Some(DistanceStep::Spline), ..Choice::default() };
    let error = Standardizer::plan(&named, Some(&without), channels).unwrap_err().to_string();
    assert!(error.contains("`spline` was asked for"), "{error}");
    let mut elsewhere = calibration;
    elsewhere.reference.distance_m = 1.0;
    assert_eq!(elsewhere.check().unwrap_err().field, "spline.reference_distance_m");
}

/// Five distances make a cubic and a warning.
#[test]
fn few_positions_are_a_warning() {
    let mut scene = Scene::builtin("board-distances-smoke").unwrap();
    let approach = scene.runs[0].approach.as_mut().unwrap();
    approach.distances_m = vec![0.6, 0.8, 1.1, 1.5, 2.0];
    let model = small(CameraModel::preset("sr3100").unwrap());
    let simulation = Simulation::new(model, scene, 1).unwrap();
    let mut sweep = DistanceSweep::new("board", &CalibrateSettings::default());
    common::render(&simulation).iter().for_each(|simulated| sweep.push(&simulated.frame).unwrap());
    let (calibration, report) =
        calibrate::fit(&CalibrateSettings::default(), None, vec![], vec![sweep.finish()]).unwrap();
    assert!(calibration.terms.cubic.is_some() && calibration.terms.spline.is_none());
    let words: Vec<String> = report.warnings.iter().map(ToString::to_string).collect();
    let expected = "positions found, at least 8 expected";
    assert!(words.iter().any(|warning| warning.contains(expected)), "{words:?}");
}
