//! `calibrate --scene`: ordinary recordings in, terms and reasons out.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "tests fail by panicking")]

mod common;

use common::Sandbox;

/// A camera with few pixels, so that a debug build is quick.
fn small_camera() -> String {
    let text = isolux_camera::CameraModel::preset_toml("sr3100").unwrap();
    [("height = 144", "height = 72"), ("width = 176", "width = 88"), ("fx = 200.0", "fx = 100.0")]
        .into_iter()
        .chain([("fy = 200.0", "fy = 100.0"), ("cx = 87.5", "cx = 43.5"), ("cy = 71.5", "cy = 35.5")])
        .fold(text.to_owned(), |text, (from, to)| {
            assert!(text.contains(from), "{from}");
            text.replace(from, to)
        })
}

fn recorded() -> Sandbox {
    let sandbox = Sandbox::new();
    sandbox.write("small.toml", small_camera());
    sandbox.run("simulate hand-held-smoke -o room --camera small.toml").done();
    sandbox
}

#[test]
fn a_hand_held_recording_gives_every_term() {
    let sandbox = recorded();
    let run = sandbox.run("calibrate --scene room -o C.json").done();
    for part in
        ["lut,", "spline,", "profile,", "angle,", "poses recorded: up to 0.8", "held out", "determined"]
    {
        assert!(run.stdout.contains(part), "no \"{part}\" in {}", run.stdout);
    }
    let json = sandbox.run("calibrate --scene room -o D.json --json").json();
    for term in ["lut", "spline", "profile", "angle"] {
        assert_eq!(json["terms"][term]["fitted_on"][0]["recording"], "room", "{term}");
        assert_eq!(json["terms"][term]["fitted_on"][0]["frames_used"], 12, "{term}");
    }
    let first = std::fs::read(sandbox.join("C.json")).unwrap();
    assert_eq!(first, std::fs::read(sandbox.join("D.json")).unwrap(), "the same input gives the same file");
    sandbox.run("standardize room -c C.json -o out --profile on --angle on").done();
}

#[test]
fn terms_of_sweeps_stay_and_a_still_scene_says_what_it_cannot_tell() {
    let sandbox = recorded();
    let scene = "version = 1\nname = \"still\"\nambient = 0.0\n[[object]]\nname = \"wall\"\n\
                 form = { rectangle = { size_m = [9.0, 9.0] } }\ncenter_m = [0.0, 0.0, 1.4]\n\
                 texture = { mosaic = { cell_m = 0.3, reflectivities = [0.3, 0.8], seed = 1 } }\n\
                 [[run]]\nskip_frames = 60\nframes_per_time = 2\nintegration_times_us = ";
    sandbox.write("times.toml", format!("{scene}[4000.0, 8000.0, 10000.0]\n"));
    sandbox.write("one.toml", format!("{scene}[8000.0]\n"));
    for name in ["times", "one"] {
        sandbox.run(&format!("simulate {name}.toml -o {name} --camera small.toml")).done();
    }
    sandbox
        .run("calibrate --exposure-sweep times --scene room -o C.json")
        .done()
        .remarks("`lut` is that of the sweeps or targets")
        .prints("profile,");
    let json = sandbox.run("calibrate --scene times -o D.json --json").json();
    assert!(json["terms"]["lut"].is_object() && json["terms"]["spline"].is_null());
    // 8200 µs is the reference: S is the ratio of the times.
    let multiplier = json["terms"]["lut"]["multiplier"][0].as_f64().unwrap();
    assert!((multiplier / 2.05 - 1.0).abs() < 0.01, "{multiplier}");
    sandbox
        .run("calibrate --scene one -o E.json")
        .refused(1, &["no calibration is written", "neither the camera nor the integration time changes"]);
    assert!(!sandbox.join("E.json").exists());
}
