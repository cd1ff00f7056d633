//! Scene and camera files: the built-in ones are right, wrong ones are refused with a message that helps.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use isolux_camera::scene::run::RegisterRange;
use isolux_camera::{CameraError, CameraModel, Scene, Simulation};

#[test]
fn every_built_in_scene_can_be_simulated_with_its_camera() {
    for name in Scene::builtin_names() {
        let scene = Scene::builtin(name).unwrap();
        assert_eq!(scene.name, name);
        assert!(!scene.description.is_empty());
        let simulation = Simulation::new(CameraModel::preset(&scene.camera).unwrap(), scene, 1).unwrap();
        assert!(simulation.len() > 0, "{name}");
        if name.ends_with("-smoke") {
            assert!(simulation.len() <= 100, "{name}: {}", simulation.len());
        }
    }
}

#[test]
fn every_preset_is_named_as_its_file_and_survives_writing() {
    for name in CameraModel::preset_names() {
        let model = CameraModel::preset(name).unwrap();
        assert_eq!(model.name, name);
        assert_eq!(CameraModel::from_toml("copy", &toml::to_string(&model).unwrap()).unwrap(), model);
    }
    let scene = Scene::builtin("example").unwrap();
    assert_eq!(Scene::from_toml("copy", &toml::to_string(&scene).unwrap()).unwrap(), scene);
}

#[test]
fn the_example_shows_every_field() {
    let text = Scene::builtin_toml("example").unwrap();
    for field in [
        "yaw_deg",
        "highlight",
        "target",
        "bitmap",
        "patches",
        "stripes",
        "checkerboard",
        "registers",
        "skip_over_saturated",
        "approach",
        "motion",
        "camera",
        "sphere",
        "cylinder",
        "cuboid",
        "rectangle",
        "uniform",
    ] {
        assert!(text.contains(field), "{field}");
    }
}

/// The example with `from` replaced, and the complaint about it.
fn complaint(from: &str, to: &str) -> String {
    let text = Scene::builtin_toml("example").unwrap();
    assert!(text.contains(from), "{from}");
    Scene::from_toml("my.toml", &text.replacen(from, to, 1)).unwrap_err().to_string()
}

/// Line of the example that has `text`.
fn line(text: &str) -> usize {
    Scene::builtin_toml("example").unwrap().lines().position(|line| line.contains(text)).unwrap() + 1
}

#[test]
fn unknown_and_missing_fields_are_named_with_their_line() {
    let message = complaint("ambient = 0.3", "ambiant = 0.3");
    assert!(message.starts_with(&format!("my.toml, line {}: ", line("ambient = "))), "{message}");
    assert!(message.contains("unknown field `ambiant`") && message.contains("`ambient`"), "{message}");
    let message = complaint("radius_m = 0.12 } }", "radius_m = 0.12, color = 1 } }");
    assert!(message.starts_with(&format!("my.toml, line {}: ", line("radius_m = 0.12"))), "{message}");
    assert!(message.contains("unexpected keys in table: color"), "{message}");
    assert!(complaint("name = \"wall\"", "").contains("missing field `name`"));
    assert!(complaint("{ sphere =", "{ ball =").contains("unknown variant `ball`"));
    assert!(complaint("exponent = 150.0", "exponent = \"big\"").contains("expected f64"));
    assert!(complaint("[[run]]", "[[run]").starts_with(&format!("my.toml, line {}: ", line("[[run]]"))));
}

#[test]
fn values_without_sense_are_named_with_their_line_and_what_is_expected() {
    let at = |text| format!("my.toml, line {}: ", line(text));
    let message = complaint("texture = { uniform = 0.6 }", "texture = { uniform = 1.6 }");
    let expected = "`object[0].texture.uniform` is 1.6; expected: a reflectivity from 0 to 1";
    assert_eq!(message, at("uniform = 0.6") + expected);
    let message = complaint("radius_m = 0.06", "radius_m = -0.06");
    assert!(
        message.starts_with(&(at("radius_m = 0.06") + "`object[3].form.cylinder.radius_m`")),
        "{message}"
    );
    let message = complaint("[1000.0, 4200.0]", "[1000.0, nan]");
    assert!(message.starts_with(&(at("[1000.0, 4200.0]") + "`run[0].integration_times_us`")), "{message}");
    let message = complaint("object = \"chart\"", "object = \"charm\"");
    assert!(message.contains("\"charm\"") && message.contains("wall, box, ball"), "{message}");
    let message = complaint("name = \"ball\"", "name = \"box\"");
    assert!(message.contains("a name that no other object has"), "{message}");
    assert!(complaint("\"#.#..#.\",", "\"#.#\",").contains("all of one length"));
    assert!(complaint("frames_per_time = 2", "frames_per_time = 0").contains("frames_per_time` is 0"));
}

#[test]
fn newer_files_are_refused_as_such_even_when_they_hold_new_fields() {
    let text = Scene::builtin_toml("example").unwrap().replacen("version = 1", "version = 2\nnew = 3", 1);
    let error = Scene::from_toml("my.toml", &text).unwrap_err();
    assert!(matches!(error, CameraError::Version { found: 2, supported: 1, .. }), "{error}");
    let text = CameraModel::preset_toml("sr3100").unwrap().replacen("version = 1", "version = 0", 1);
    assert!(CameraModel::from_toml("my.toml", &text).unwrap_err().to_string().contains("`version` is 0"));
}

#[test]
fn cameras_without_sense_are_refused() {
    let text = CameraModel::preset_toml("sr3100").unwrap();
    let complaint = |from: &str, to: &str| {
        CameraModel::from_toml("my.toml", &text.replacen(from, to, 1)).unwrap_err().to_string()
    };
    let message = complaint("softness = 8.0", "softness = 0.0");
    assert!(
        message.contains("line ") && message.contains("`softness` is 0.0; expected: 1 to 12"),
        "{message}"
    );
    assert!(complaint("fx = 200.0", "fx = 0.0").contains("fx and fy positive"));
    assert!(complaint("fx = 200.0", "fz = 1.0\nfx = 200.0").contains("unknown field `fz`"));
    assert!(complaint("step_us = 200.0", "step_us = -1.0").contains("`integration_register.step_us`"));
    assert!(complaint("width = 176", "width = 0").contains("1 to 8192 pixels"));
}

#[test]
fn unknown_names_list_the_known_ones() {
    let message = Scene::builtin("wal").unwrap_err().to_string();
    assert!(message.contains("`wal`") && message.contains("wall-sweep"), "{message}");
    assert!(CameraModel::preset("x").unwrap_err().to_string().contains("sr3100, kinect2-like, o3d-like"));
}

#[test]
fn recordings_that_cannot_be_made_are_refused() {
    let model = CameraModel::preset("sr3100").unwrap();
    let with = |change: &dyn Fn(&mut Scene)| {
        let mut scene = Scene::builtin("board-distances").unwrap();
        change(&mut scene);
        Simulation::new(model.clone(), scene, 1).unwrap_err().to_string()
    };
    let message = with(&|scene| {
        scene.runs[0].integration_times_us.clear();
        scene.runs[0].registers = Some(RegisterRange { first: 0, last: 256, step: 1 });
    });
    assert!(message.contains("`run[0].registers.last` is 256") && message.contains("255"), "{message}");
    let message = with(&|scene| scene.runs[0].integration_times_us = vec![1e8]);
    assert!(message.contains("over-saturated at every integration time"), "{message}");
    let message = with(&|scene| scene.runs[0].frames_per_time = 100_000);
    assert!(message.contains("asks for 15600000 frames"), "{message}");
    let message = with(&|scene| scene.ambient = f64::NAN);
    assert!(message.contains("`ambient` is NaN"), "{message}");
}
