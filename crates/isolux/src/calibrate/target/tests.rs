//! Rendered boards with known factors: do the terms come back?

use super::*;
use crate::calibrate::factor_terms::FactorWarning;
use crate::calibrate::{
    CalibrateError, CalibrateSettings, ExposureFit, FitWarning, MeasureError, Measurements,
};
use crate::frame::{Frame, Intrinsics, Lens, Plane, Shape};
use crate::terms::profile::Places;

const SHAPE: Shape = Shape::new(60, 80);
const INTRINSICS: Intrinsics = Intrinsics { fx: 90.0, fy: 90.0, cx: 39.5, cy: 29.5 };
const EXPONENT: f64 = 1.4;

fn ln_profile([x, y]: [f64; 2]) -> f64 {
    -1.1 * (x * x + y * y) + 0.06 * x
}

/// A board through (0, 0, z), `slant` its slopes over x and y, that fills the image; 1 % of noise.
fn board(z: f64, slant: [f64; 2], state: &mut u64) -> Frame {
    let mut frame = Frame::new(SHAPE);
    let places = Places::new(SHAPE, Some(&INTRINSICS.into()));
    let mut distances = Plane::filled(SHAPE, 0.0);
    for index in 0..SHAPE.pixels() {
        let (row, column) = ((index / SHAPE.width) as f64, (index % SHAPE.width) as f64);
        let [x, y, _] = INTRINSICS.ray(row, column);
        let inverse = (1.0 - slant[0] * x - slant[1] * y) / z;
        let per_depth = (x * x + y * y + 1.0).sqrt();
        let distance = per_depth / inverse;
        let cosine = inverse * z / ((1.0 + slant[0].powi(2) + slant[1].powi(2)).sqrt() * per_depth);
        *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let noise = 0.035 * ((*state >> 11) as f64 / (1u64 << 53) as f64 - 0.5);
        let ln = ln_profile(places.at(row, column)) + EXPONENT * cosine.ln() - 2.0 * (distance / 0.75).ln();
        frame.amplitude.values_mut()[index] = (1000.0 * (ln + noise).exp()) as f32;
        distances.values_mut()[index] = distance as f32;
    }
    frame.distance_m = Some(distances);
    frame.target = Some(Plane::filled(SHAPE, 3));
    frame.flag_amplitude(None);
    frame
}

fn calibrated(frames: &[Frame], intrinsics: Option<Intrinsics>) -> (crate::Calibration, Vec<FitWarning>) {
    let settings = CalibrateSettings::default();
    let mut sweep = TargetSweep::new("board", &settings, intrinsics.map(Lens::from));
    frames.iter().try_for_each(|frame| sweep.push(frame)).unwrap();
    let mut measured = Measurements::default();
    measured.add_target(sweep.finish());
    let (calibration, report) =
        ExposureFit::new(&settings, Vec::new()).unwrap().complete(None, measured).unwrap();
    calibration.check().unwrap();
    (calibration, report.warnings)
}

#[test]
fn a_tilted_board_gives_back_law_profile_and_exponent() {
    let mut state = 1;
    let slants = [[0.0, 0.0], [0.9, 0.2], [-0.8, 0.5], [0.1, -1.0], [0.5, 0.9]];
    let frames: Vec<Frame> =
        (0..15).map(|i| board(0.6 * 1.1f64.powi(i), slants[i as usize % 5], &mut state)).collect();
    let (calibration, warnings) = calibrated(&frames, Some(INTRINSICS));
    assert_eq!(warnings, []);
    // 1 % of noise, medians of 25 pixels, 15 × 192 windows: errors of a thousandth; five of them, and the normals'.
    let angle = calibration.terms.angle.unwrap();
    assert!((angle.exponent - EXPONENT).abs() < 0.01, "{angle:?}");
    let profile = calibration.terms.profile.unwrap();
    let places = profile.places();
    for cell in 0..Places::CELLS[0] * Places::CELLS[1] {
        let place = places.cell_centre(cell);
        assert!(profile.supports(place));
        assert!((profile.ln_gain(place) - ln_profile(place)).abs() < 0.01, "{place:?}");
    }
    let spline = calibration.terms.spline.unwrap();
    for step in 0..=20 {
        let d = 0.7 * 3f64.powf(f64::from(step) / 20.0);
        assert!((spline.ln_response(d) + 2.0 * (d / 0.75).ln()).abs() < 0.01, "{d}");
    }
}

#[test]
fn a_board_that_always_faces_the_camera_tells_no_exponent_and_says_so() {
    let mut state = 2;
    let frames: Vec<Frame> = (0..10).map(|i| board(0.6 * 1.15f64.powi(i), [0.0; 2], &mut state)).collect();
    let (calibration, warnings) = calibrated(&frames, Some(INTRINSICS));
    assert!(calibration.terms.angle.is_none() && calibration.terms.profile.is_some());
    assert!(
        warnings.iter().any(|warning| matches!(
            warning,
            FitWarning::Target(TargetWarning::Factor(FactorWarning::Refused { .. }))
        )),
        "{warnings:?}"
    );
    assert!(warnings.contains(&FitWarning::Target(TargetWarning::LambertAssumed)));
    // Without intrinsics, no angle at all.
    let (calibration, warnings) = calibrated(&frames, None);
    assert!(calibration.terms.angle.is_none());
    assert!(
        warnings.contains(&FitWarning::Target(TargetWarning::NoIntrinsics { recording: "board".to_owned() })),
        "{warnings:?}"
    );
}

#[test]
fn recordings_without_labels_or_windows_are_refused() {
    let settings = CalibrateSettings::default();
    let mut sweep = TargetSweep::new("board", &settings, None);
    let mut frame = board(1.0, [0.0; 2], &mut 3);
    frame.target = None;
    assert_eq!(sweep.push(&frame), Err(MeasureError::NoTarget { frame: 0 }));
    frame.target = Some(Plane::filled(SHAPE, 0));
    sweep.push(&frame).unwrap();
    let mut measured = Measurements::default();
    measured.add_target(sweep.finish());
    assert!(matches!(
        ExposureFit::new(&settings, Vec::new()).unwrap().complete(None, measured),
        Err(CalibrateError::Target(_))
    ));
}
