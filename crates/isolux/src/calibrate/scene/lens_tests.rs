//! The same room through lenses that are no pinholes.

use std::sync::Arc;

use super::*;
use crate::frame::{Distortion, RayTable};

fn equidistant() -> Lens {
    let distortion = Distortion::named("equidistant", &[]).unwrap().unwrap();
    Lens::Distorted(Intrinsics { fx: 65.0, fy: 65.0, ..PINHOLE }, distortion)
}

fn pushed(lens: &Lens, poses: &[Rigid], motion: CameraMotion) -> Result<SceneObservations, String> {
    let mut sweep = SceneSweep::new("room", &settings(), Some(lens.clone()), motion);
    for (number, pose) in poses.iter().enumerate() {
        let frame = frame_through(lens, &room(), pose, TIMES_US[number % 2], number as u64 + 1);
        sweep.push(&frame).map_err(|error| error.to_string())?;
    }
    Ok(sweep.finish())
}

#[test]
fn a_fisheye_in_the_hand_tells_as_much_as_a_pinhole() {
    let scene = pushed(&equidistant(), &carried(16, 0.6), CameraMotion::Recorded).unwrap();
    let (calibration, report) = fit(scene);
    assert_eq!(refused(&report), [], "{:?}", report.scene);
    let [law, gain, time] = deviations(&calibration);
    // It looks half as far again off its axis, where fewer surfaces are seen.
    assert!(law < CURVE && gain < 1.5 * CURVE && time < 3e-3, "{law} {gain} {time}");
    let angle = calibration.terms.angle.as_ref().unwrap();
    assert!((angle.exponent - 1.0).abs() < 0.1, "{}", angle.exponent);
}

#[test]
fn a_table_of_rays_does_for_a_camera_that_stands_and_not_for_one_that_moves() {
    let fisheye = equidistant();
    let at = |index: usize| fisheye.ray(SHAPE, index / SHAPE.width, index % SHAPE.width).unwrap();
    let values: Vec<f64> = (0..SHAPE.pixels()).flat_map(at).collect();
    let table = Lens::Rays(Arc::new(RayTable::new(SHAPE, &values).unwrap()));
    let message = pushed(&table, &carried(2, 0.3), CameraMotion::Recorded).unwrap_err();
    assert!(
        message.contains("a table of rays found") && message.contains("beam angles expected"),
        "{message}"
    );
    let stands = vec![pose([0.0; 3], [0.0; 3]); 4];
    let scene = pushed(&table, &stands, CameraMotion::Still).unwrap();
    let same = pushed(&fisheye, &stands, CameraMotion::Still).unwrap();
    let (found, expected) = (scene.observations.len(), same.observations.len());
    assert!(scene.motion == MotionFinding::Still && expected > 100, "{expected}");
    // Followed through any pinhole, which bends some of the facets.
    assert!(found * 2 > expected, "{found} {expected}");
}
