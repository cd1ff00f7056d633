//! Self-calibration on a camera that nothing was tuned on, small enough for a debug build. The full figures:
//! `cargo run --release -p isolux-experiments --example self_calibration`.
#![allow(clippy::unwrap_used, reason = "tests fail by panicking")]

use isolux::calibrate::MotionFinding;
use isolux::calibrate::joint::Factor;
use isolux_camera::CameraModel;
use isolux_experiments::unseen::self_calibration::{
    Experiment, Poses, RunKind, SelfCalibration, Spoil, measure,
};

/// A held-out camera with a quarter of the pixels.
fn camera() -> CameraModel {
    let mut camera = CameraModel::random(104);
    (camera.height, camera.width) = (camera.height / 2, camera.width / 2);
    for value in [
        &mut camera.intrinsics.fx,
        &mut camera.intrinsics.fy,
        &mut camera.intrinsics.cx,
        &mut camera.intrinsics.cy,
    ] {
        *value *= 0.5;
    }
    camera
}

fn run(kind: RunKind, poses: Poses) -> SelfCalibration {
    let scene = kind.scene(18).unwrap();
    measure(&Experiment { camera: camera(), scene, poses, spoil: Some(Spoil::USUAL), seed: 1 }).unwrap()
}

/// A quarter of the pixels in half of the frames: errors of the full run, 0.2 %, times the root of eight, and four
/// of these for the largest of many.
const CURVE: f64 = 0.025;

#[test]
fn an_unknown_room_gives_the_laws_of_an_unseen_camera() {
    let found = run(RunKind::HandHeld, Poses::Recorded);
    assert!(matches!(found.motion, MotionFinding::Recorded(_)), "{:?}", found.motion);
    let [time, distance, profile] = [found.time, found.distance, found.profile].map(Option::unwrap);
    assert!(time.largest < 3e-3 && distance.largest < CURVE && profile.largest < CURVE, "{found:?}");
    assert!(distance.typical < 0.4 * CURVE && profile.typical < 0.4 * CURVE, "{found:?}");
    assert!((found.angle_exponent.unwrap() - 1.0).abs() < 0.05, "{found:?}");
    assert!((0.03..0.09).contains(&found.report.outlier_share), "{}", found.report.outlier_share);
}

#[test]
fn what_a_recording_cannot_tell_is_refused() {
    let told = |kind: RunKind| {
        let found = run(kind, Poses::Recorded);
        let all = [Factor::Time, Factor::Distance, Factor::Profile, Factor::Angle];
        let told: Vec<Factor> = all.into_iter().filter(|&factor| found.determines(factor)).collect();
        let written = [found.time.is_some(), found.distance.is_some(), found.profile.is_some()];
        assert_eq!(written, [Factor::Time, Factor::Distance, Factor::Profile].map(|f| told.contains(&f)));
        assert!(
            told.len() == 1 && kind == RunKind::StillManyTimes || !found.warnings.is_empty(),
            "{found:?}"
        );
        told
    };
    assert_eq!(told(RunKind::StillOneTime), []);
    assert_eq!(told(RunKind::StillManyTimes), [Factor::Time]);
    assert_eq!(told(RunKind::Turning), [Factor::Profile]);
    assert_eq!(told(RunKind::TowardsWall), [Factor::Distance]);
}
