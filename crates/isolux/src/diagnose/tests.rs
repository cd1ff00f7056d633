//! The diagnosis on made-up frames whose law is known.

use super::*;
use crate::frame::{Frame, IntegrationTime, Plane, Shape};

/// A frame of amplitudes `law(row, column)`; distances and times are set by the caller.
fn frame(shape: Shape, law: impl Fn(usize, usize) -> f64) -> Frame {
    let mut frame = Frame::new(shape);
    frame.amplitude = Plane::from_fn(shape, |row, column| law(row, column) as f32);
    frame.flag_amplitude(None);
    frame
}

fn diagnose(frames: &[Frame]) -> Diagnosis {
    let mut diagnoser = Diagnoser::new(frames[0].shape(), DiagnoseSettings::default());
    frames.iter().for_each(|frame| diagnoser.push(frame).unwrap());
    diagnoser.finish()
}

/// Uneven, reproducible, 0.5..1.5, the same in every frame.
fn material(row: usize, column: usize) -> f64 {
    0.5 + (crate::numerics::hash::splitmix64((row * 1000 + column) as u64) >> 11) as f64 / (1u64 << 53) as f64
}

const SHAPE: Shape = Shape::new(48, 64);
const TIMES_US: [f64; 4] = [500.0, 1000.0, 2000.0, 4000.0];

fn sweep(law: impl Fn(f64, f64) -> f64) -> Vec<Frame> {
    let at = |time_us: f64| {
        let mut frame = frame(SHAPE, |row, column| law(time_us, 100.0 * material(row, column)));
        frame.integration_time_us = IntegrationTime::PerFrame(time_us);
        frame
    };
    TIMES_US.map(at).to_vec()
}

#[test]
fn a_still_scene_tells_the_exponent_of_time_whatever_the_materials() {
    for exponent in [1.0, 0.0, 0.5, 2.0, -1.0] {
        let diagnosis = diagnose(&sweep(|time_us, material| material * (time_us / 1000.0).powf(exponent)));
        let time = diagnosis.time.unwrap();
        // Amplitudes are f32: 6e-8 relative, over a factor of 8 in time.
        assert!((time.exponent.value - exponent).abs() < 1e-6, "{time:?}");
        assert_eq!(time.state, State::of_time(time.exponent));
        assert_eq!(diagnosis.distance, Err(Unavailable::NoDistance));
    }
}

#[test]
fn a_logarithm_is_seen_as_compression() {
    let diagnosis = diagnose(&sweep(|time_us, material| 300.0 * (1.0 + material * time_us / 5e4).ln()));
    let compressed = diagnosis.findings.iter().any(|finding| matches!(finding, Finding::Compressed { .. }));
    assert!(compressed, "{:?}", diagnosis.findings);
}

/// What `law(eq. 1, number)` is told to be, eq. 1 spanning a factor of 3 in space and of 8 in time; `number` is
/// uniform in 0.5..1.5 and has nothing to do with it.
fn against_phase_samples(law: impl Fn(f64, f64) -> f64) -> (Vec<Finding>, Diagnosis) {
    let at = |(number, time_us): (usize, f64)| {
        let level = |row, column| 0.2 * time_us * material(row, column);
        let mut frame = frame(SHAPE, |row, column| {
            law(level(row, column), material(row + SHAPE.height * (1 + number), column))
        });
        // Eq. 1 of (a, 0, -a, 0) is proportional to a.
        let bin = |share: f64| Plane::from_fn(SHAPE, |row, column| (share * level(row, column)) as f32);
        frame.phase_samples = Some([1.0, 0.0, -1.0, 0.0].map(bin));
        frame.integration_time_us = IntegrationTime::PerFrame(time_us);
        frame
    };
    let diagnosis = diagnose(&TIMES_US.into_iter().enumerate().map(at).collect::<Vec<_>>());
    let of_phase_samples = |finding: &&Finding| {
        matches!(finding, Finding::EqualsPhaseSamples | Finding::Gamma { from_phase_samples: true, .. })
    };
    (diagnosis.findings.iter().filter(of_phase_samples).cloned().collect(), diagnosis)
}

#[test]
fn what_its_phase_samples_do_not_explain_is_not_said_to_follow_from_them() {
    assert_eq!(against_phase_samples(|level, _| 3.0 * level).0, [Finding::EqualsPhaseSamples]);
    let (found, _) = against_phase_samples(|level, _| level.sqrt());
    // Amplitudes are f32: 6e-8 relative, over a factor of 24.
    assert!(matches!(found[..], [Finding::Gamma { gamma, .. }] if (gamma - 0.5).abs() < 1e-6), "{found:?}");
    // Steps of 1 DN at 50 DN and more are 0.6 % and less: still the same image.
    assert_eq!(against_phase_samples(|level, _| level.round()).0, [Finding::EqualsPhaseSamples]);

    // A factor of 0.5 to 1.5 by chance, and an image of something else.
    let laws: [&dyn Fn(f64, f64) -> f64; 2] = [&|level, number| level * number, &|_, number| 300.0 * number];
    for law in laws {
        let (found, diagnosis) = against_phase_samples(law);
        assert!(found.is_empty(), "{found:?}");
        // Uniform numbers in 0.5..1.5 scatter by about 30 % around their median.
        assert!(diagnosis.phase_samples.unwrap().residual > 0.2);
    }
}

#[test]
fn wide_intervals_and_missing_exponents_are_no_equality() {
    let (_, diagnosis) = against_phase_samples(|level, _| level);
    let exact = diagnosis.phase_samples.unwrap();
    let wide = |value: f64| Estimate { value, low_95: value - 1.0, high_95: value + 1.0 };
    let mut uncertain = vec![exact.clone(); 4];
    uncertain[0].gamma = None;
    uncertain[1].gamma = Some(wide(1.0));
    uncertain[2].time = Ok(wide(0.0));
    if let Ok(radial) = &mut uncertain[3].radial {
        radial.corner_factor = wide(1.0);
    }
    assert!(rules::equals_phase_samples(&exact).is_some());
    for scaling in &uncertain {
        assert_eq!(rules::equals_phase_samples(scaling), None, "{scaling:?}");
    }
}

#[test]
fn what_was_not_recorded_is_not_told() {
    let unknown = frame(SHAPE, material);
    let mut constant = unknown.clone();
    constant.integration_time_us = IntegrationTime::PerFrame(1000.0);
    assert_eq!(diagnose(&[unknown.clone(), unknown]).time, Err(Unavailable::TimeUnknown));
    let diagnosis = diagnose(&[constant.clone(), constant]);
    assert_eq!(diagnosis.time, Err(Unavailable::TimeConstant { time_us: 1000.0 }));
    assert_eq!(diagnosis.headline(), "raw or corrected: cannot be told");
    assert_eq!(diagnosis.vendor_scaling, Err(Unavailable::NoChannel { channel: "vendor_amplitude" }));
}

#[test]
fn a_scene_that_moves_with_the_times_is_no_still_scene() {
    let mut frames = sweep(|time_us, material| material * time_us);
    for (number, frame) in frames.iter_mut().enumerate() {
        frame.distance_m = Some(Plane::filled(SHAPE, 1.0 + number as f32));
    }
    assert!(matches!(diagnose(&frames).time, Err(Unavailable::SceneMoved { share }) if share == 0.75));
}

/// One material in steps of distance, tilted so that r² and d are not one.
#[test]
fn a_labelled_target_tells_the_exponent_of_distance() {
    let law = |exponent: f64| {
        let at = |step: usize| {
            let distance_m = move |column: usize| 0.5 + 0.3 * step as f64 + 0.004 * column as f64;
            let mut frame = frame(SHAPE, |row, column| {
                1000.0
                    * distance_m(column).powf(exponent)
                    * (1.0 + 0.1 * (material(row, column + 64 * step) - 1.0))
            });
            frame.distance_m = Some(Plane::from_fn(SHAPE, |_, column| distance_m(column) as f32));
            frame.target = Some(Plane::filled(SHAPE, 7));
            frame
        };
        diagnose(&(0..10).map(at).collect::<Vec<_>>())
    };
    for (exponent, state) in [(-2.0, State::Present), (0.0, State::Removed), (-1.0, State::Reduced)] {
        let distance = law(exponent).distance.unwrap();
        let error = (distance.exponent.high_95 - distance.exponent.value) / 1.96;
        assert!((distance.exponent.value - exponent).abs() < 5.0 * error, "{distance:?}");
        // Noise ±5 %, uniform, σ 2.9 %, on 30 000 pixels with σ(ln d) ≈ 0.4: 4e-4, a few times that for shared blocks.
        assert!(error < 2e-3, "{distance:?}");
        assert_eq!((distance.state, distance.evidence), (state, Evidence::Target { label: 7 }));
    }
}

#[test]
fn pile_up_and_coarse_steps_are_seen_and_a_full_range_is_not() {
    let values = |law: &dyn Fn(f64) -> f64| {
        diagnose(&[frame(SHAPE, |row, column| law(1000.0 * (material(row, column) - 0.4)))]).values.unwrap()
    };
    assert_eq!((values(&|a| a).pile_up, values(&|a| a).levels), (None, None));
    assert_eq!(values(&f64::round).pile_up, None);
    let clipped = values(&|a| a.min(600.0)).pile_up.unwrap();
    // Uniform on 100..1100: half lie above; binomial, σ 0.9 %.
    assert!(clipped.value_dn == 600.0 && (clipped.fraction - 0.5).abs() < 0.045, "{clipped:?}");
    let coarse = values(&|a| (a / 10.0).round());
    assert!(coarse.pile_up.is_none() && coarse.levels == Some(101), "{coarse:?}");
    assert_eq!(values(&|_| 5.0).pile_up, None);
}

#[test]
fn odd_input_is_no_accident() {
    for shape in [Shape::new(3, 3), Shape::new(1, 1), Shape::new(1, 2000)] {
        let mut dark = frame(shape, |_, _| 0.0);
        dark.distance_m = Some(Plane::filled(shape, f32::NAN));
        dark.vendor_amplitude = Some(Plane::filled(shape, f32::INFINITY));
        dark.target = Some(Plane::filled(shape, 1));
        dark.integration_time_us = IntegrationTime::PerPixel(Plane::filled(shape, f32::NAN));
        let diagnosis = diagnose(&[dark]);
        assert!(diagnosis.values.is_none() && diagnosis.findings.is_empty());
        assert!(
            [&diagnosis.time, &diagnosis.distance, &diagnosis.radius].iter().all(|effect| effect.is_err())
        );
        let lit = diagnose(&[frame(shape, material)]);
        assert!(lit.time.is_err() && serde_json::to_value(&lit).is_ok());
    }
    let mut diagnoser = Diagnoser::new(SHAPE, DiagnoseSettings::default());
    assert!(diagnoser.push(&Frame::new(Shape::new(2, 2))).is_err());
}

#[test]
fn the_reason_is_readable_by_program_and_by_person() {
    let diagnosis = diagnose(&[frame(SHAPE, material)]);
    let json = serde_json::to_value(&diagnosis).unwrap();
    assert_eq!(json["time"]["unavailable"], "time_unknown");
    assert!(json["distance"]["because"].as_str().unwrap().contains("no distance channel"));
}
