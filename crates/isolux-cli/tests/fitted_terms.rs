//! Terms that the program fits, writes, reads and uses.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "tests fail by panicking")]

mod common;

use std::fs;

use common::{run, simulate};
use isolux::Calibration;
use serde_json::Value;

/// Calibrate and standardize with the program: the frequency comes from the recording.
#[test]
fn the_spline_is_fitted_and_used() {
    let folder = tempfile::tempdir().unwrap();
    simulate(folder.path(), "board-distances-smoke");
    let (board, file) = (folder.path().join("board-distances-smoke"), folder.path().join("CAMERA.json"));
    let printed = run(&[&"calibrate", &"--distance-sweep", &board, &"-o", &file]);
    assert!(printed.contains("spline, law over distance: "), "{printed}");
    let written: Value = serde_json::from_slice(&fs::read(&file).unwrap()).unwrap();
    let spline = &written["terms"]["spline"];
    assert_eq!(spline["version"], 1);
    assert_eq!(spline["coefficients"].as_array().unwrap().len(), 27);
    for (options, term) in [
        (&["--time", "none"][..], "spline"),
        (&["--time", "none", "--distance", "spline"], "spline"),
        (&["--time", "none", "--distance", "cubic"], "cubic"),
    ] {
        let out = folder.path().join(format!("out-{}-{term}", options.len()));
        let mut args: Vec<&dyn AsRef<std::ffi::OsStr>> =
            vec![&"standardize", &board, &"-c", &file, &"-o", &out];
        args.extend(options.iter().map(|option| option as &dyn AsRef<std::ffi::OsStr>));
        if options.len() == 4 {
            args.push(&"--force");
        }
        run(&args);
        let record: Value = serde_json::from_slice(&fs::read(out.join("recording.json")).unwrap()).unwrap();
        let steps = record["standardization"]["steps"].as_array().unwrap();
        assert_eq!(steps.iter().find(|step| step["effect"] == "distance").unwrap()["term"], term);
    }
}

/// Simulate, calibrate and standardize with the program; the file is checked as any other.
#[test]
fn the_response_is_fitted_and_used() {
    let folder = tempfile::tempdir().unwrap();
    let (sweep, file) = (folder.path().join("wall"), folder.path().join("CAMERA.json"));
    run(&[&"simulate", &"wall-sweep-smoke", &"-o", &sweep, &"--phase-samples", &"--ambient", &"1.5"]);
    let record: Value = serde_json::from_slice(&fs::read(sweep.join("recording.json")).unwrap()).unwrap();
    assert_eq!(record["simulation"]["ambient"], 1.5);
    let printed = run(&[&"calibrate", &"--exposure-sweep", &sweep, &"-o", &file]);
    for tier in ["scalar", "amplitude", "pixel (that scene)", "intensity", "phase_samples"] {
        assert!(printed.contains(&format!("\n  {tier}  ")), "{tier}: {printed}");
    }
    let written: Value = serde_json::from_slice(&fs::read(&file).unwrap()).unwrap();
    let response = &written["terms"]["response"];
    assert_eq!(response["pixel"]["full_well_time_us"].as_array().unwrap().len(), 144);
    assert_eq!(response["phase_samples"]["modulation_frequency_hz"], 20e6);
    let read: Calibration = serde_json::from_slice(&fs::read(&file).unwrap()).unwrap();
    assert_eq!(read.check(), Ok(()));
    for (options, expected) in [
        (&[][..], "tier phase_samples: amplitude and distance"),
        (&["--time", "response", "--response-tier", "intensity"], "tier intensity: "),
        (&["--time", "response", "--response-tier", "pixel"], "tier pixel: the static scene of the sweep"),
        (&["--time", "response", "--response-tier", "scalar"], "tier scalar: 1 at 8200 µs"),
        (&["--time", "lut"], "1 at 8200 µs"),
    ] {
        let out = folder.path().join("out");
        let mut args: Vec<&dyn AsRef<std::ffi::OsStr>> =
            vec![&"standardize", &sweep, &"-c", &file, &"-o", &out, &"--distance", &"none", &"--force"];
        args.extend(options.iter().map(|option| option as &dyn AsRef<std::ffi::OsStr>));
        run(&args);
        let record: Value = serde_json::from_slice(&fs::read(out.join("recording.json")).unwrap()).unwrap();
        let step = &record["standardization"]["steps"][0];
        assert!(step["parameters"].as_str().unwrap().contains(expected), "{step}");
    }
}
