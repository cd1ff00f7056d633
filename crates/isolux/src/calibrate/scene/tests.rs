//! A room whose truth is known, seen by a camera whose laws are known.

use nalgebra::{Rotation3, Vector3};

use super::rigid::Rigid;
use super::*;
use crate::calibrate::joint::Factor;
use crate::calibrate::{CalibrateSettings, ExposureFit, FitReport, FitWarning, Measurements};
use crate::calibration::{Calibration, Reference};
use crate::frame::{Frame, IntegrationTime, Intrinsics, Lens, Shape};
use crate::numerics::hash::splitmix64;
use crate::terms::lut::LutAnswer;

#[path = "lens_tests.rs"]
mod lenses;

const SHAPE: Shape = Shape { height: 66, width: 88 };
const PINHOLE: Intrinsics = Intrinsics { fx: 80.0, fy: 80.0, cx: 43.0, cy: 33.0 };
const NOISE: f64 = 0.02;
const TIMES_US: [f64; 2] = [4000.0, 8000.0];

/// Walls `normal · p = offset`, seen from inside.
type Walls = Vec<(Vector3<f64>, f64)>;

fn room() -> Walls {
    let wall = |x: f64, y: f64, z: f64, offset: f64| (Vector3::new(x, y, z).normalize(), offset);
    vec![
        wall(0.1, 0.0, 1.0, 2.1),
        wall(-1.0, 0.1, 0.2, 0.9),
        wall(1.0, 0.0, 0.1, 1.0),
        wall(0.0, 1.0, 0.1, 0.7),
        wall(0.1, -1.0, 0.2, 0.8),
    ]
}

fn wall() -> Walls {
    vec![(Vector3::z(), 2.0)]
}

/// Number `index` of a stream, uniform in 0..1.
fn uniform(stream: u64, index: u64) -> f64 {
    (splitmix64(splitmix64(stream) ^ index) >> 11) as f64 / (1u64 << 53) as f64
}

/// Twelve uniform numbers make a normal one.
fn normal(stream: u64, index: u64) -> f64 {
    (0..12).map(|part| uniform(stream, 12 * index + part)).sum::<f64>() - 6.0
}

/// The camera's laws, 0 at 0.75 m and in the principal point.
fn ln_h(distance_m: f64) -> f64 {
    let decay = |d: f64| -2.0 * d.ln() - 0.5 * (d * d + 0.04).ln() + d.ln();
    decay(distance_m) - decay(0.75)
}

fn ln_v(row: f64, column: f64) -> f64 {
    let [x, y, _] = PINHOLE.ray(row, column);
    -2.5 * (1.0 + x * x + y * y).ln()
}

/// One frame from a pose.
fn frame(walls: &Walls, pose: &Rigid, time_us: f64, seed: u64) -> Frame {
    frame_through(&PINHOLE.into(), walls, pose, time_us, seed)
}

fn frame_through(lens: &Lens, walls: &Walls, pose: &Rigid, time_us: f64, seed: u64) -> Frame {
    let mut frame = Frame::new(SHAPE);
    let mut distances = frame.amplitude.clone();
    for index in 0..SHAPE.pixels() {
        let (row, column) = ((index / SHAPE.width) as f64, (index % SHAPE.width) as f64);
        let seen = lens.ray(SHAPE, index / SHAPE.width, index % SHAPE.width).unwrap();
        let ray = pose.rotation * Vector3::from(seen).normalize();
        let hit = |(number, (normal, offset)): (usize, &(Vector3<f64>, f64))| {
            let distance = (offset - normal.dot(&pose.translation)) / normal.dot(&ray);
            (distance > 0.0).then_some((distance, normal.dot(&ray), number))
        };
        let nearest = walls.iter().enumerate().filter_map(hit).min_by(|a, b| a.0.total_cmp(&b.0));
        let (distance_m, cosine, number) = nearest.unwrap();
        let place = pose.translation + ray * distance_m;
        let tile = place.map(|value| (value / 0.31).floor() as i64 as u64);
        let reflectivity = 0.2 + 0.6 * uniform(77 + number as u64, tile[0] ^ tile[1] << 16 ^ tile[2] << 32);
        let ln_amplitude = (2000.0 * reflectivity * cosine).ln()
            + ln_h(distance_m)
            + ln_v(row, column)
            + (time_us / 8000.0).ln()
            + NOISE * normal(2 * seed, index as u64);
        // One pixel in twenty is anything.
        let outlier = uniform(3 * seed + 1, index as u64) < 0.05;
        let factor = if outlier { 3.0 * uniform(5 * seed + 2, index as u64) } else { 1.0 };
        frame.amplitude.values_mut()[index] = (ln_amplitude.exp() * factor) as f32;
        let noise_m = 0.01 * normal(2 * seed + 1, index as u64);
        distances.values_mut()[index] = (distance_m + noise_m) as f32;
    }
    frame.distance_m = Some(distances);
    frame.integration_time_us = IntegrationTime::PerFrame(time_us);
    let [r, t] = [pose.rotation.transpose(), nalgebra::Matrix3::from_columns(&[pose.translation; 3])];
    let line = |i: usize| [r[(0, i)], r[(1, i)], r[(2, i)], t[(i, 0)]];
    frame.world_from_camera = Some([line(0), line(1), line(2), [0.0, 0.0, 0.0, 1.0]]);
    frame.flag_amplitude(None);
    frame
}

fn pose(center_m: [f64; 3], [tilt, yaw, roll]: [f64; 3]) -> Rigid {
    let rotation = Rotation3::from_euler_angles(tilt.to_radians(), yaw.to_radians(), roll.to_radians());
    Rigid { rotation: rotation.into_inner(), translation: Vector3::from(center_m) }
}

/// A hand's way through the room, starting at the origin and coming as near to the back wall as `reach_m` twice over.
fn carried(frames: u32, reach_m: f64) -> Vec<Rigid> {
    (0..frames)
        .map(|number| {
            let s = std::f64::consts::TAU * f64::from(number) / f64::from(frames);
            let center_m = [0.15 * (2.0 * s).sin(), 0.12 * s.sin(), reach_m * (1.0 - s.cos())];
            pose(center_m, [8.0 * s.sin(), 14.0 * (2.0 * s).sin(), 25.0 * s.sin()])
        })
        .collect()
}

fn settings() -> CalibrateSettings {
    let reference = Reference { integration_time_us: Some(8000.0), distance_m: 0.9 };
    CalibrateSettings { reference, ..CalibrateSettings::default() }
}

fn measure(walls: &Walls, poses: &[Rigid], times_us: &[f64], motion: CameraMotion) -> SceneObservations {
    let mut sweep = SceneSweep::new("room", &settings(), Some(PINHOLE.into()), motion);
    for (number, pose) in poses.iter().enumerate() {
        let frame = frame(walls, pose, times_us[number % times_us.len()], number as u64 + 1);
        sweep.push(&frame).unwrap();
    }
    sweep.finish()
}

fn fit(scene: SceneObservations) -> (Calibration, FitReport) {
    let mut measured = Measurements::default();
    measured.add_scene(scene);
    ExposureFit::new(&settings(), Vec::new()).unwrap().complete(None, measured).unwrap()
}

fn refused(report: &FitReport) -> Vec<Factor> {
    let findings = &report.scene.as_ref().unwrap().findings;
    findings.iter().filter(|finding| finding.refusal.is_some()).map(|finding| finding.factor).collect()
}

/// Largest deviation of h over its range, of v over its support, of S.
fn deviations(calibration: &Calibration) -> [f64; 3] {
    let spline = calibration.terms.spline.as_ref().unwrap();
    let [min_m, max_m] = spline.law.valid_distance_m;
    let law = (0..=40).map(|i| min_m + (max_m - min_m) * f64::from(i) / 40.0);
    let law = law.map(|d| (spline.ln_response(d) - ln_h(d) + ln_h(0.9)).abs()).fold(0.0, f64::max);
    let profile = calibration.terms.profile.as_ref().unwrap();
    let pixels = (0..SHAPE.pixels()).map(|i| ((i / SHAPE.width) as f64, (i % SHAPE.width) as f64));
    let gain = pixels.filter_map(|(row, column)| {
        let place = profile.places().at(row, column);
        profile.supports(place).then(|| (profile.ln_gain(place) - ln_v(row, column)).abs())
    });
    let LutAnswer::Inside(multiplier) = calibration.terms.lut.as_ref().unwrap().at(4000.0) else { panic!() };
    [law, gain.fold(0.0, f64::max), (multiplier / 2.0).ln().abs()]
}

/// Predicted standard errors are 0.1 to 0.3 % here; the largest of some hundred correlated points is about four of
/// them, and the normals' errors add as much.
const CURVE: f64 = 0.025;

#[test]
fn a_camera_in_the_hand_tells_everything_of_unknown_surfaces() {
    let scene = measure(&room(), &carried(16, 0.6), &TIMES_US, CameraMotion::Recorded);
    let (calibration, report) = fit(scene);
    assert_eq!(refused(&report), [], "{:?}", report.scene);
    let [law, gain, time] = deviations(&calibration);
    assert!(law < CURVE && gain < CURVE && time < 3e-3, "{law} {gain} {time}");
    let angle = calibration.terms.angle.as_ref().unwrap();
    assert!((angle.exponent - 1.0).abs() < 0.1, "{}", angle.exponent);
    let found = report.scene.unwrap();
    // 5 % outliers, a tenth of them too near the truth to be told; surfaces' edges add some.
    assert!((0.03..0.09).contains(&found.outlier_share), "{}", found.outlier_share);
    let held_out = found.held_out_residual.unwrap();
    // Noise and unevenness, √(1 + 1/n) for n looks at a surface, outliers within the cutoff.
    assert!((NOISE..2.0 * NOISE).contains(&held_out), "{held_out}");
    assert!(calibration.check().is_ok());
}

#[test]
fn the_motion_is_estimated_where_it_is_not_recorded() {
    let poses = carried(24, 0.3);
    let mut sweep = SceneSweep::new("room", &settings(), Some(PINHOLE.into()), CameraMotion::Estimated);
    for (number, pose) in poses.iter().enumerate() {
        let frame = frame(&room(), pose, TIMES_US[number % 2], number as u64 + 1);
        sweep.push(&Frame { world_from_camera: None, ..frame }).unwrap();
    }
    let first = poses[0].inverse();
    for (number, found) in &sweep.path.poses {
        let truth = first.after(&poses[*number as usize]);
        let away_m = (found.translation - truth.translation).norm();
        // The noise of 10 mm over hundreds of surfaces, times the lever of walls that the camera slides along.
        assert!(away_m < 0.04, "frame {number}: {away_m}");
    }
    let scene = sweep.finish();
    assert!(matches!(scene.motion, MotionFinding::Estimated { frames_lost: ..3, .. }), "{:?}", scene.motion);
    // So short a way tells less than a long one, but no less than it does with the true poses.
    let (calibration, report) = fit(scene);
    let recorded = measure(&room(), &poses, &TIMES_US, CameraMotion::Recorded);
    assert_eq!(refused(&report), refused(&fit(recorded).1));
    let LutAnswer::Inside(multiplier) = calibration.terms.lut.as_ref().unwrap().at(4000.0) else { panic!() };
    assert!((multiplier / 2.0 - 1.0).abs() < 5e-3, "{multiplier}");
}

#[test]
fn a_single_plane_does_not_tell_the_motion() {
    let poses: Vec<Rigid> =
        (0..8).map(|i| pose([0.05 * f64::from(i), 0.0, 0.1 * f64::from(i)], [0.0; 3])).collect();
    let scene = measure(&wall(), &poses, &TIMES_US, CameraMotion::Estimated);
    let MotionFinding::Refused(refusal) = scene.motion else { panic!("{:?}", scene.motion) };
    assert!(matches!(refusal.reason, MotionObstacle::Slides { .. }), "{refusal}");
    assert!(scene.observations.is_empty() && scene.source.frames_used == 0);
    let (calibration, report) = fit(scene);
    assert_eq!(calibration.terms, crate::calibration::Terms::default());
    assert!(
        matches!(report.warnings[0], FitWarning::Scene(SceneWarning::MotionRefused { .. })),
        "{:?}",
        report.warnings
    );
}

#[test]
fn a_still_camera_tells_the_time_alone_and_with_one_time_nothing() {
    let still = vec![Rigid::identity(); 6];
    let (calibration, report) = fit(measure(&room(), &still, &TIMES_US, CameraMotion::Still));
    let found = &report.scene.as_ref().unwrap().findings;
    assert_eq!(found.iter().map(|finding| finding.factor).collect::<Vec<_>>(), [Factor::Time]);
    let terms = &calibration.terms;
    assert!(terms.spline.is_none() && terms.profile.is_none() && terms.angle.is_none());
    let LutAnswer::Inside(multiplier) = terms.lut.as_ref().unwrap().at(4000.0) else { panic!() };
    assert!((multiplier / 2.0 - 1.0).abs() < 3e-3, "{multiplier}");
    assert_eq!(calibration.reference.integration_time_us, Some(8000.0));
    let (calibration, report) = fit(measure(&room(), &still, &[8000.0], CameraMotion::Recorded));
    assert_eq!(calibration.terms, crate::calibration::Terms::default());
    assert_eq!(report.warnings, [FitWarning::Scene(SceneWarning::NothingVaries)]);
}

#[test]
fn a_turning_camera_tells_the_profile_alone() {
    let turns: Vec<Rigid> = (0..10)
        .map(|i| pose([0.0; 3], [7.0 * f64::from(i % 3), 6.0 * f64::from(i) - 20.0, 9.0 * f64::from(i)]))
        .collect();
    let (calibration, report) = fit(measure(&room(), &turns, &[8000.0], CameraMotion::Recorded));
    assert!(calibration.terms.profile.is_some(), "{:?}", report.warnings);
    assert!(calibration.terms.spline.is_none() && calibration.terms.angle.is_none());
}

#[test]
fn towards_a_wall_the_profile_cannot_be_told_from_the_angle() {
    let steps: Vec<Rigid> = (0..10).map(|i| pose([0.0, 0.0, 0.13 * f64::from(i)], [0.0; 3])).collect();
    let (calibration, report) = fit(measure(&wall(), &steps, &[8000.0], CameraMotion::Recorded));
    assert!(calibration.terms.spline.is_some(), "{:?}", report.warnings);
    assert!(calibration.terms.profile.is_none() && calibration.terms.angle.is_none());
}

#[test]
fn recordings_that_lack_what_they_should_have_are_refused_by_frame() {
    let good = frame(&room(), &Rigid::identity(), 8000.0, 1);
    let push = |intrinsics, motion, frame: &Frame| {
        SceneSweep::new("room", &settings(), intrinsics, motion)
            .push(frame)
            .map_err(|error| error.to_string())
    };
    let with = |change: &dyn Fn(&mut Frame)| {
        let mut frame = good.clone();
        change(&mut frame);
        push(Some(PINHOLE.into()), CameraMotion::Recorded, &frame).unwrap_err()
    };
    assert!(with(&|frame| frame.distance_m = None).contains("frame 0: no distance"));
    assert!(with(&|frame| frame.world_from_camera = None).contains("frame 0: no pose"));
    let message = with(&|frame| frame.world_from_camera = Some([[2.0, 0.0, 0.0, 0.0]; 4]));
    assert!(message.contains("no rigid transform"), "{message}");
    assert!(push(None, CameraMotion::Estimated, &good).unwrap_err().contains("no intrinsics"));
    assert_eq!(push(None, CameraMotion::Still, &good), Ok(()));
    // A frame without a usable pixel is left out.
    let mut sweep = SceneSweep::new("dark", &settings(), Some(PINHOLE.into()), CameraMotion::Recorded);
    sweep.push(&Frame { distance_m: Some(good.amplitude.clone()), ..Frame::new(SHAPE) }).unwrap();
    let scene = sweep.finish();
    assert_eq!((scene.source.frames_used, scene.source.frames_left_out), (0, 1));
}

#[test]
fn a_first_look_tells_where_poses_come_from() {
    let verdict = |frames: &[Frame]| {
        let mut scout = MotionScout::default();
        frames.iter().for_each(|frame| scout.push(frame));
        scout.verdict()
    };
    let frames: Vec<Frame> =
        carried(6, 0.3).iter().enumerate().map(|(i, pose)| frame(&room(), pose, 8000.0, i as u64)).collect();
    assert_eq!(verdict(&frames), CameraMotion::Recorded);
    let mut without = frames.clone();
    without.iter_mut().for_each(|frame| frame.world_from_camera = None);
    assert_eq!(verdict(&without), CameraMotion::Estimated);
    assert_eq!(verdict(&vec![without[0].clone(); 3]), CameraMotion::Still);
}
