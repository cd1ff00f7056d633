//! `calibrate --target` and `standardize --profile --angle` through the program.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "tests fail by panicking")]

mod common;

use common::run;
use isolux_io::read_calibration;

#[test]
fn a_target_gives_terms_that_standardize_uses_by_name() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let (board, calibration, output) = (path("board"), path("CAMERA.json"), path("out"));
    run(&[&"simulate", &"patches-smoke", &"-o", &board]);
    let words = run(&[&"calibrate", &"--target", &board, &"-o", &calibration]);
    assert!(words.contains("targets, all factors together"), "{words}");
    let terms = read_calibration(&calibration).unwrap().terms;
    assert!(terms.lut.is_none() && terms.cubic.is_none());
    let steps = |arguments: &[&dyn AsRef<std::ffi::OsStr>]| {
        let mut all: Vec<&dyn AsRef<std::ffi::OsStr>> =
            vec![&"standardize", &board, &"-o", &output, &"--force", &"--json"];
        all.extend_from_slice(arguments);
        let summary: serde_json::Value = serde_json::from_str(&run(&all)).unwrap();
        let steps = summary["steps"].as_array().unwrap().clone();
        steps.iter().map(|step| step["term"].as_str().unwrap().to_owned()).collect::<Vec<_>>()
    };
    // Without a calibration, the angle is Lambert's.
    assert_eq!(steps(&[&"--angle", &"on"]), ["linear", "square", "lambert", "histogram"]);
    let fitted =
        steps(&[&"-c", &calibration, &"--time", &"none", &"--distance", &"square", &"--angle", &"on"]);
    let profile = terms.profile.is_some().then_some("profile");
    let angle = if terms.angle.is_some() { "angle" } else { "lambert" };
    let expected: Vec<&str> = ["square"].into_iter().chain(profile).chain([angle, "histogram"]).collect();
    assert_eq!(fitted, expected);
}
