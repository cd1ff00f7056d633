//! The response on cameras that nobody has fitted it to: what the fits find against the truth, and how a chain uses
//! it. How much better images become: `crates/isolux-experiments/tests/response.rs`.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "tests fail by panicking")]

mod common;

use common::render;
use common::standardize::{standardize, try_standardize};
use isolux::calibrate::{self, CalibrateSettings, ExposureSweep};
use isolux::standardize::{DistanceStep, SpecularStep, StandardizeError, TimeStep};
use isolux::terms::response::{Response, ResponseTier};
use isolux::{Advice, Calibration, Channels, Choice, Frame, PixelFlags, RecordingKind, Shape, Standardizer};
use isolux_camera::{CameraModel, Scene, Simulation};

/// A small image of the built-in wall in this light, over 24 times evenly spread in ln t.
fn wall(mut model: CameraModel, ambient: f64, longest_us: f64, seed: u64) -> Simulation {
    (model.height, model.width) = (32, 48);
    (model.intrinsics.cy, model.intrinsics.cx) = (15.5, 23.5);
    let mut scene = Scene::builtin("wall-sweep").unwrap();
    scene.ambient = ambient;
    scene.runs[0].registers = None;
    scene.runs[0].integration_times_us =
        (0..24).map(|i| longest_us * 0.01f64.powf(1.0 - f64::from(i) / 23.0)).collect();
    scene.runs[0].frames_per_time = 4;
    // Ten times the slowest warm-up.
    scene.runs[0].skip_frames = 300;
    Simulation::new(model, scene, seed).unwrap()
}

/// Two and a half full wells by the mean, where the whole wall clips.
fn longest_us(model: &CameraModel, ambient: f64) -> f64 {
    2.5 * model.full_well_electrons / (0.7 * model.radiometric_electrons_per_us * (ambient + 1.0 / 0.81))
}

fn fitted(simulation: &Simulation) -> Calibration {
    let model = simulation.model();
    let settings = CalibrateSettings {
        modulation_frequency_hz: Some(model.modulation_frequency_hz),
        reference: isolux::Reference { integration_time_us: Some(2000.0), distance_m: 0.75 },
        ..CalibrateSettings::default()
    };
    let mut sweep = ExposureSweep::new("wall", &settings);
    render(simulation).iter().for_each(|simulated| sweep.push(&simulated.frame).unwrap());
    calibrate::fit(&settings, None, vec![sweep.finish()], vec![]).unwrap().0
}

fn response(calibration: &Calibration) -> &Response {
    calibration.terms.response.as_ref().unwrap()
}

fn channels() -> Channels {
    Channels::AMPLITUDE
        | Channels::DISTANCE
        | Channels::INTEGRATION_TIME
        | Channels::INTENSITY
        | Channels::PHASE_SAMPLES
}

/// The fit rests on some 200 pixels, four bins of each, of which at least three times are bent by more than a tenth: 2400
/// points with a noise (W ≥ 60 000 electrons, means of 4 frames) of at most 1/√(4·60 000) = 0.2 % of W, worth
/// 0.2 %/√2400 = 4e-5 of W by themselves. W and p are correlated, and so are both with each pixel's light, which is
/// fitted to the same points: a variance inflation of 100 to 1000 gives 4e-4 to 1.3e-3 for W. Twice that is allowed, and
/// ten times that for p, of which f depends by an order less.
const BINS_W: f64 = 2.5e-3;
const BINS_P: f64 = 2.5e-2;
/// With the phase unknown, the fourfold ripple of 2 to 5 per cent stays in the bent amplitudes. A wall that faces the
/// camera has few phases to average it over; the fit takes it for a part of the well.
const DC_W: f64 = 3e-2;
const DC_P: f64 = 0.1;

#[test]
fn sweeps_of_unseen_cameras_give_their_well() {
    for seed in [101, 102, 103, 104] {
        let model = CameraModel::random(seed);
        for ambient in [0.0, 2.0] {
            let simulation = wall(model.clone(), ambient, longest_us(&model, ambient), seed);
            let calibration = fitted(&simulation);
            let tiers = response(&calibration);
            let w = model.gain_dn_per_electron * model.full_well_electrons;
            let bins = tiers.phase_samples.as_ref().unwrap();
            let dc = tiers.intensity.as_ref().unwrap();
            println!(
                "{seed} {ambient}: {w} {} {} | {:?} | {:?}",
                model.softness, model.black_level_dn, bins.well, dc.well
            );
            assert!((bins.well.full_well_dn / w - 1.0).abs() < BINS_W, "{seed} {ambient} {bins:?}");
            assert!((bins.well.softness / model.softness - 1.0).abs() < BINS_P, "{seed} {ambient} {bins:?}");
            assert!((bins.well.black_level_dn - model.black_level_dn).abs() < 1e-3 * w, "{seed} {bins:?}");
            assert!((dc.well.full_well_dn / w - 1.0).abs() < DC_W, "{seed} {ambient} {dc:?}");
            assert!((dc.well.softness / model.softness - 1.0).abs() < DC_P, "{seed} {ambient} {dc:?}");
            // The simulated DC image has its black level taken out.
            assert!(dc.well.black_level_dn.abs() < 1e-3 * w, "{seed} {ambient} {dc:?}");
            // No bin that may be clipped is inverted.
            assert!(bins.largest_dn <= 0.99 * model.clip_dn(), "{seed} {ambient} {bins:?}");
        }
    }
}

/// Raw bins repair the distance: compression of bins shifts the phase between the eighths of the circle.
#[test]
fn the_bins_repair_the_distance() {
    let model = CameraModel::random(105);
    let simulation = wall(model.clone(), 0.0, longest_us(&model, 0.0), 5);
    let calibration = fitted(&simulation);
    let frames = render(&simulation);
    let largest = response(&calibration).phase_samples.as_ref().unwrap().largest_dn;
    // Distances show as the square of themselves: amplitudes of d² law over those without.
    let plan = |distance, tier| {
        let choice = Choice {
            time: Some(TimeStep::Response),
            response_tier: Some(tier),
            distance: Some(distance),
            specular: Some(SpecularStep::None),
            ..Choice::default()
        };
        Standardizer::plan(&choice, Some(&calibration), channels()).unwrap()
    };
    let [with, without] =
        [DistanceStep::Square, DistanceStep::None].map(|step| plan(step, ResponseTier::PhaseSamples));
    let (mut raw, mut repaired, mut count) = (0.0, 0.0, 0.0f64);
    for simulated in &frames {
        let [far, near] = [&with, &without].map(|plan| standardize(plan, &simulated.frame));
        let bins = simulated.frame.phase_samples.as_ref().unwrap();
        for i in 0..simulation.shape().pixels() {
            let highest = bins.iter().map(|bin| f64::from(bin.values()[i])).fold(0.0, f64::max);
            let value = far.amplitude.values()[i];
            assert_eq!(
                value.is_nan(),
                highest > largest || !simulated.frame.is_valid(i),
                "{highest} {largest}"
            );
            // The bent ones: the highest bin beyond four fifths of the range.
            if value.is_nan() || highest < 0.8 * largest {
                continue;
            }
            let truth = f64::from(simulated.truth.true_distance_m.values()[i]);
            let distance = 0.75 * f64::from(value / near.amplitude.values()[i]).sqrt();
            raw += f64::from(simulated.frame.distance_m.as_ref().unwrap().values()[i]) - truth;
            repaired += distance - truth;
            count += 1.0;
        }
    }
    let (raw, repaired) = (raw / count, repaired / count);
    println!("{count} pixels: {:.2} mm raw, {:.2} mm repaired", 1e3 * raw, 1e3 * repaired);
    assert!(count > 1000.0 && raw.abs() > 2e-3 && repaired.abs() < 0.1 * raw.abs(), "{raw} {repaired}");
}

#[test]
fn best_takes_the_best_tier_that_recording_and_calibration_allow_and_never_the_map() {
    let model = CameraModel::random(106);
    let calibration = fitted(&wall(model.clone(), 0.0, longest_us(&model, 0.0), 6));
    let plan = |choice: &Choice, calibration: &Calibration, channels| {
        let standardizer = Standardizer::plan(choice, Some(calibration), channels)?;
        let step = standardizer.steps().iter().find(|step| step.effect == "time").unwrap();
        Ok::<_, isolux::standardize::PlanError>(format!("{} {}", step.term, step.parameters))
    };
    let best = |channels| plan(&Choice::default(), &calibration, channels).unwrap();
    let named = Choice { time: Some(TimeStep::Response), ..Choice::default() };
    assert!(best(channels()).starts_with("response tier phase_samples: "));
    assert!(best(channels() - Channels::PHASE_SAMPLES).starts_with("response tier intensity: "));
    let amplitude_only = Channels::AMPLITUDE | Channels::INTEGRATION_TIME;
    assert!(best(amplitude_only).starts_with("linear "));
    let words = plan(&named, &calibration, amplitude_only).unwrap();
    assert!(words.starts_with("response tier amplitude: "), "{words}");
    let tier = |tier| Choice { response_tier: Some(tier), ..named };
    let words = plan(&tier(ResponseTier::Pixel), &calibration, amplitude_only).unwrap();
    assert!(words.contains("static scene"), "{words}");
    let error = plan(&tier(ResponseTier::Intensity), &calibration, amplitude_only).unwrap_err().to_string();
    assert!(error.contains("`intensity` was asked for, but the recording has no intensity"), "{error}");
    let mut without = calibration.clone();
    without.terms.response.as_mut().unwrap().intensity = None;
    let error = plan(&tier(ResponseTier::Intensity), &without, channels()).unwrap_err().to_string();
    assert!(error.contains("the calibration does not hold it"), "{error}");
    without.terms.response = None;
    let error = plan(&named, &without, channels()).unwrap_err();
    assert!(error.to_string().contains("`response` was asked for"), "{error}");
    assert_eq!(error.advice(), Some(Advice::CalibrateFrom(RecordingKind::ExposureSweep)));
}

#[test]
fn what_the_response_cannot_tell_is_refused() {
    let model = CameraModel::random(107);
    let simulation = wall(model.clone(), 0.0, longest_us(&model, 0.0), 7);
    let calibration = fitted(&simulation);
    let plan = |tier| {
        let choice = Choice {
            time: Some(TimeStep::Response),
            response_tier: Some(tier),
            specular: Some(SpecularStep::None),
            ..Choice::default()
        };
        let choice = Choice { distance: Some(DistanceStep::None), ..choice };
        Standardizer::plan(&choice, Some(&calibration), channels()).unwrap()
    };
    let frames = render(&simulation);
    let last = &frames[frames.len() - 1].frame;
    for tier in [
        ResponseTier::PhaseSamples,
        ResponseTier::Intensity,
        ResponseTier::Pixel,
        ResponseTier::Amplitude,
        ResponseTier::Scalar,
    ] {
        let standardizer = plan(tier);
        // The whole wall is clipped at the end of the sweep.
        let out = standardize(&standardizer, last);
        if matches!(tier, ResponseTier::PhaseSamples | ResponseTier::Intensity | ResponseTier::Scalar) {
            assert!(out.amplitude.values().iter().all(|value| value.is_nan()), "{tier:?}");
        }
        for (value, flags) in out.amplitude.values().iter().zip(out.flags.values()) {
            assert_eq!(value.is_nan(), flags.contains(PixelFlags::INVALID), "{tier:?}");
        }
        // A pixel that the reader calls saturated has no linear value.
        let mut first = frames[0].frame.clone();
        first.flags.values_mut()[5] |= PixelFlags::SATURATED;
        let out = standardize(&standardizer, &first);
        let summary = out.summary;
        assert_eq!(out.amplitude.values()[5].is_nan(), tier != ResponseTier::Scalar, "{tier:?}");
        assert!(summary.valid * 10 > summary.pixels * 9, "{tier:?} {summary:?}");
    }
    let mut other = Frame::new(Shape::new(2, 2));
    other.integration_time_us = isolux::IntegrationTime::PerFrame(1000.0);
    let error = try_standardize(&plan(ResponseTier::Pixel), &other).unwrap_err();
    assert!(matches!(error, StandardizeError::AnotherScene { .. }), "{error}");
    let error = try_standardize(&plan(ResponseTier::Intensity), &other).unwrap_err();
    assert_eq!(error, StandardizeError::FillMissing { channel: "intensity" });
}

/// Hand-edited files are refused by the field, not obeyed.
#[test]
fn impossible_parameters_are_refused() {
    let model = CameraModel::random(108);
    let good = fitted(&wall(model.clone(), 0.0, longest_us(&model, 0.0), 8));
    let spoil = |change: fn(&mut Response)| {
        let mut calibration = good.clone();
        change(calibration.terms.response.as_mut().unwrap());
        calibration.check().unwrap_err().field
    };
    assert_eq!(spoil(|r| r.version = 2), "response.version");
    assert_eq!(spoil(|r| r.scalar.as_mut().unwrap().softness = 0.0), "response.scalar.softness");
    assert_eq!(
        spoil(|r| r.scalar.as_mut().unwrap().full_well_time_us = f64::NAN),
        "response.scalar.full_well_time_us"
    );
    assert_eq!(spoil(|r| r.amplitude.as_mut().unwrap().hinge_dn[0] = -1.0), "response.amplitude.hinge_dn");
    assert_eq!(spoil(|r| r.amplitude.as_mut().unwrap().increment[0] = -1.0), "response.amplitude.increment");
    assert_eq!(
        spoil(|r| r.pixel.as_mut().unwrap().full_well_time_us[3].truncate(7)),
        "response.pixel.full_well_time_us"
    );
    assert_eq!(spoil(|r| r.pixel.as_mut().unwrap().largest_fill = f64::NAN), "response.pixel.largest_fill");
    assert_eq!(spoil(|r| r.intensity.as_mut().unwrap().largest_dn = 1e9), "response.intensity.largest_dn");
    assert_eq!(
        spoil(|r| r.phase_samples.as_mut().unwrap().well.full_well_dn = 0.0),
        "response.phase_samples.well.full_well_dn"
    );
    let mut timeless = good;
    timeless.terms.lut = None;
    timeless.reference.integration_time_us = None;
    assert_eq!(timeless.check().unwrap_err().field, "reference.integration_time_us");
}
