//! Lenses in `recording.json`: the spellings, what is not used, what is refused.
#![allow(clippy::unwrap_used, clippy::panic, reason = "tests fail by panicking")]

use std::path::Path;

use isolux::Lens;
use isolux_io::{RecordingError, RecordingInfo};
use serde_json::Value;

fn info(text: &str) -> Result<RecordingInfo, RecordingError> {
    RecordingInfo::from_json(text.as_bytes(), Path::new("recording.json"))
}

fn with(fields: &str) -> Result<RecordingInfo, RecordingError> {
    info(&format!(r#"{{"intrinsics": {{"fx": 90, "fy": 90, "cx": 40, "cy": 30{fields}}}}}"#))
}

fn described(fields: &str) -> (String, Option<String>) {
    let description = with(fields).unwrap().lens();
    (description.lens.unwrap().to_string(), description.unused.map(|unused| unused.to_string()))
}

#[test]
fn one_lens_has_many_spellings() {
    let spellings = [
        r#", "k1": 0.1, "k2": -0.02, "p1": 0.001, "p2": 0.002, "k3": 0.03"#,
        r#", "model": "plumb_bob", "coeffs": [0.1, -0.02, 0.001, 0.002, 0.03]"#,
        r#", "distortion_model": "Brown-Conrady", "D": [0.1, -0.02, 0.001, 0.002, 0.03]"#,
        r#", "distortion": [0.1, -0.02, 0.001, 0.002, 0.03]"#,
        r#", "distortion": {"model": "radtan", "k1": 0.1, "k2": -0.02, "p1": 0.001, "p2": 0.002, "k3": 0.03}"#,
        r#", "distortion": "brown", "coefficients": [0.1, -0.02, 0.001, 0.002, 0.03, 0, 0, 0]"#,
    ];
    let lenses: Vec<_> = spellings.iter().map(|fields| with(fields).unwrap().lens()).collect();
    for (lens, spelling) in lenses.iter().zip(spellings) {
        assert_eq!(lens, &lenses[0], "{spelling}");
    }
    assert_eq!(lenses[0].lens.as_ref().unwrap().to_string(), "Brown–Conrady, 5 coefficients");
    for (fields, expected) in [
        ("", "pinhole"),
        (r#", "k1": 0"#, "pinhole"),
        (r#", "model": "plumb_bob", "D": []"#, "pinhole"),
        (r#", "name": "L", "width": 640"#, "pinhole"),
        (r#", "k1": 0.45, "k2": 0.1, "k4": 0.8, "model": "rational""#, "rational polynomial, 8 coefficients"),
        (r#", "D": [1, 1, 0, 0, 1, 1, 1, 1], "model": null"#, "rational polynomial, 8 coefficients"),
        (r#", "k1": 1, "k6": 0.8"#, "rational polynomial, 8 coefficients"),
        (r#", "model": "equidistant", "k1": 0.1, "k4": 0.2"#, "Kannala–Brandt fisheye, 4 coefficients"),
        (
            r#", "model": "KANNALA_BRANDT4", "coeffs": [0.1, 0, 0, 0, 0]"#,
            "Kannala–Brandt fisheye, 4 coefficients",
        ),
        (r#", "model": "fisheye""#, "Kannala–Brandt fisheye, 4 coefficients"),
        (
            r#", "model": "inverse_brown_conrady", "coeffs": [0.1, 0, 0, 0, 0]"#,
            "inverse Brown–Conrady, 5 coefficients",
        ),
    ] {
        assert_eq!(described(fields), (expected.to_owned(), None), "{fields}");
    }
}

#[test]
fn named_and_listed_coefficients_of_a_fisheye_are_the_same() {
    let named = with(r#", "model": "kb4", "k1": 0.1, "k2": 0.2, "k3": 0.3, "k4": 0.4"#).unwrap().lens();
    assert_eq!(named, with(r#", "model": "fisheye", "D": [0.1, 0.2, 0.3, 0.4]"#).unwrap().lens());
    assert!(with(r#", "model": "kb4", "k1": 0.1, "p1": 0.2"#).is_err());
}

#[test]
fn what_is_not_used_is_said() {
    let (lens, unused) = described(r#", "model": "ftheta", "k1": 0.1, "k2": 3"#);
    let unused = unused.unwrap();
    assert_eq!(lens, "pinhole");
    assert!(
        unused.starts_with("`intrinsics.k1, k2` not used: a distortion model named `ftheta` found, one of"),
        "{unused}"
    );
    let (lens, unused) = described(r#", "k1": 0.45, "k2": 0.1, "k4": 0.8"#);
    let unused = unused.unwrap();
    assert_eq!(lens, "pinhole");
    assert!(unused.starts_with("`intrinsics.k1, k2, k4` not used: they belong to"), "{unused}");
}

#[test]
fn what_makes_no_lens_is_refused_with_its_field() {
    let cases = [
        (r#", "model": 3"#, "field `intrinsics.model`: found 3, expected the name"),
        (r#", "k1": "0.1""#, "field `intrinsics.k1`: found \"0.1\", expected a finite number"),
        (r#", "D": [1, null]"#, "field `intrinsics.D`: found [1,null], expected a list of finite numbers"),
        (
            r#", "model": "plumb_bob", "D": [0.1, 0.2]"#,
            "field `intrinsics.D`: found [0.1,0.2], expected 4 or 5",
        ),
        (r#", "model": "kb4", "D": [0.1, 0.2, 0, 0, 1]"#, "expected 4 (k1, k2, k3, k4)"),
    ];
    for (fields, expected) in cases {
        let message = with(fields).unwrap_err().to_string();
        assert!(message.contains(expected), "{fields}: {message}");
    }
}

#[test]
fn beams_are_found_where_ouster_has_them() {
    let beams = r#""beam_altitude_angles": [10, 0, -10], "beam_azimuth_angles": [1, 2, 3]"#;
    let texts = [
        format!("{{{beams}}}"),
        format!(r#"{{"beam_intrinsics": {{{beams}, "lidar_origin_to_beam_origin_mm": 27.7}}}}"#),
        format!(r#"{{"intrinsics": {{{beams}}}}}"#),
    ];
    for text in texts {
        let read = info(&text).unwrap();
        let Some(Lens::Spinning(lidar)) = read.lens().lens else { panic!("{text}") };
        assert_eq!(lidar.beams(), 3);
        let written = serde_json::to_value(&read).unwrap();
        assert_eq!(written, serde_json::from_str::<Value>(&text).unwrap());
    }
    let message = |text: &str| info(text).unwrap_err().to_string();
    assert!(message(r#"{"beam_altitude_angles": [1, "x"]}"#).contains("field `beam_altitude_angles`"));
    let uneven = r#"{"beam_altitude_angles": [1, 2], "beam_azimuth_angles": [1]}"#;
    assert!(message(uneven).contains("field `beam_azimuth_angles`"), "{}", message(uneven));
}
