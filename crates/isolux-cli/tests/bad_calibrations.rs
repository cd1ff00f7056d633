//! Calibration files that are damaged, foreign, newer or impossible: refused with the file and the field.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "tests fail by panicking")]

mod common;

use common::{Sandbox, calibration, sandbox};
use serde_json::{Value, json};

/// Both commands that take a calibration refuse this text and leave the folder as it was.
fn refused(sandbox: &Sandbox, text: &str, parts: &[&str]) {
    sandbox.write("camera.json", text);
    let before = sandbox.snapshot();
    for command in ["standardize rec -c camera.json -o out", "evaluate rec -c camera.json --json"] {
        sandbox.run(command).refused(1, &[&["`camera.json`"], parts].concat());
        sandbox.expect_unchanged(&before, command);
    }
}

#[test]
fn files_that_are_no_calibration() {
    let sandbox = sandbox();
    let text = calibration().to_string();
    refused(&sandbox, "", &["no valid JSON", "expected a calibration of isolux"]);
    refused(&sandbox, &text[..text.len() / 2], &["no valid JSON"]);
    refused(&sandbox, &format!("{text} x"), &["no valid JSON", "trailing characters"]);
    refused(&sandbox, &"[".repeat(100_000), &["no valid JSON", "recursion limit"]);
    refused(&sandbox, "[]", &["JSON without `format`"]);
    refused(&sandbox, "{\"format\": \"camera-tuning\", \"version\": 1}", &["the format `camera-tuning`"]);
    refused(&sandbox, "{\"format\": \"isolux-calibration\"}", &["no usable `version`"]);
    refused(&sandbox, "{\"format\": \"isolux-calibration\", \"version\": -1}", &["no usable `version`"]);
    let doubled = text.replacen("\"version\":1", "\"version\":1,\"version\":1", 1);
    refused(&sandbox, &doubled, &["duplicate field `version`"]);
    refused(&sandbox, &text.replacen("0.75", "NaN", 1), &["no valid JSON", "line 1"]);
    refused(&sandbox, &text.replacen("0.75", "1e999", 1), &["no valid JSON", "out of range"]);
    sandbox
        .isolux(&["standardize", "rec", "-c", "none.json", "-o", "out"])
        .refused(1, &["cannot open `none.json`"]);
    sandbox.isolux(&["standardize", "rec", "-c", "rec", "-o", "out"]).refused(1, &["`rec`"]);
}

/// A field's path, its impossible value, and what the message must name.
type Spoilt = (&'static str, Value, &'static [&'static str]);

#[test]
fn fields_that_are_unknown_newer_or_impossible() {
    let cases: [Spoilt; 24] = [
        ("/version", json!(2), &["format version 2, expected at most 1", "update isolux"]),
        ("/gamma", json!(2.2), &["unknown field `gamma`"]),
        ("/terms/wavelet", json!({}), &["unknown field `wavelet`"]),
        ("/terms/lut/gamma", json!(1), &["unknown field `gamma`"]),
        ("/terms/lut/fit/gamma", json!(1), &["unknown field `gamma`"]),
        ("/reference/distance_mm", json!(750), &["unknown field `distance_mm`"]),
        ("/terms/cubic/coefficients", json!([1, 2, 3]), &["array of length 4"]),
        ("/terms/lut/multiplier", json!("big"), &["invalid type"]),
        ("/reference/integration_time_us", json!(-1), &["reference.integration_time_us: -1", "a time in µs"]),
        ("/reference/integration_time_us", Value::Null, &["reference.integration_time_us"]),
        ("/reference/distance_m", json!(0), &["reference.distance_m: 0"]),
        ("/terms/lut/version", json!(2), &["lut.version: 2"]),
        ("/terms/cubic/version", json!(0), &["cubic.version: 0"]),
        ("/terms/lut/integration_time_us", json!([1.0]), &["lut.integration_time_us: 1 times"]),
        ("/terms/lut/integration_time_us", json!([1, 4, 2]), &["lut.integration_time_us", "increasing"]),
        (
            "/terms/lut/integration_time_us",
            json!([0, 1, 2]),
            &["lut.integration_time_us", "increasing positive times"],
        ),
        ("/terms/lut/multiplier", json!([1, 1]), &["lut.multiplier: 2 for 3"]),
        ("/terms/lut/multiplier", json!([1, 1, 0]), &["lut.multiplier", "numbers from 1e-12 to 1e12"]),
        (
            "/terms/lut/valid_integration_time_us",
            json!([1000, 9000]),
            &["lut.valid_integration_time_us: 1000..9000"],
        ),
        ("/terms/lut/valid_integration_time_us", json!([3000, 2000]), &["lut.valid_integration_time_us"]),
        ("/terms/cubic/valid_distance_m", json!([3, 0.5]), &["cubic.valid_distance_m: 3..0.5"]),
        ("/terms/cubic/valid_distance_m", json!([0, 1]), &["cubic.valid_distance_m"]),
        (
            "/terms/cubic/coefficients",
            json!([-1, 0, 0, 0]),
            &["cubic.coefficients", "a multiplier from 1e-12 to 1e12"],
        ),
        (
            "/noise_floor",
            json!({"amplitude_sd_dn": -1, "integration_time_us": 1000, "low_signal_below_dn": 5}),
            &["noise_floor"],
        ),
    ];
    let sandbox = sandbox();
    let good = calibration();
    sandbox.write("camera.json", good.to_string());
    sandbox.run("standardize rec -c camera.json -o out").done();
    std::fs::remove_dir_all(sandbox.join("out")).unwrap();
    for (field, value, parts) in cases {
        let (parent, name) = field.rsplit_once('/').unwrap();
        let mut spoilt = good.clone();
        spoilt.pointer_mut(parent).unwrap()[name] = value;
        refused(&sandbox, &spoilt.to_string(), parts);
    }
}

/// Values that are finite in f64 but leave no finite multiplier in f32, in which images are computed.
#[test]
fn multipliers_that_no_image_can_hold() {
    let cases: [Spoilt; 4] = [
        ("/terms/lut/multiplier", json!([1e308, 1e308, 1e308]), &["lut.multiplier"]),
        ("/terms/lut/multiplier", json!([5e-324, 5e-324, 5e-324]), &["lut.multiplier"]),
        ("/terms/cubic/coefficients", json!([1e308, 1e308, 1e308, 1e308]), &["cubic.coefficients"]),
        ("/reference/distance_m", json!(1e-300), &["reference.distance_m"]),
    ];
    let sandbox = sandbox();
    let good = calibration();
    for (field, value, parts) in cases {
        let mut spoilt = good.clone();
        *spoilt.pointer_mut(field).unwrap() = value;
        refused(&sandbox, &spoilt.to_string(), parts);
    }
}
