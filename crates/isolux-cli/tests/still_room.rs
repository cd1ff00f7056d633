//! A still room, simulated, calibrated and evaluated by the program itself.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "tests fail by panicking")]

mod common;

use common::{run, simulate};

/// A still room at integration times within the table's range; the slanted board has one label.
const ROOM: &str = r#"
    version = 1
    name = "room"
    ambient = 0.5
    [[object]]
    name = "back-wall"
    form = { rectangle = { size_m = [20.0, 20.0] } }
    center_m = [0.0, 0.0, 1.8]
    texture = { uniform = 0.5 }
    [[object]]
    name = "slanted-board"
    form = { rectangle = { size_m = [0.9, 0.3] } }
    center_m = [-0.2, -0.15, 1.1]
    yaw_deg = 60.0
    target = 1
    texture = { uniform = 0.8 }
    [[object]]
    name = "box"
    form = { cuboid = { size_m = [0.3, 0.2, 0.2] } }
    center_m = [0.25, 0.2, 1.2]
    yaw_deg = 25.0
    texture = { stripes = { period_m = 0.08, reflectivities = [0.7, 0.2] } }
    [[run]]
    integration_times_us = [1000.0, 2000.0, 4200.0, 8200.0, 12000.0]
    frames_per_time = 2
    skip_frames = 50
"#;

/// Simulated, calibrated and evaluated by the program itself: what the paper promises of a still room.
#[test]
fn evaluation_of_a_still_room_goes_the_right_way() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let (wall, board) = (path("wall-sweep-smoke"), path("board-distances-smoke"));
    simulate(folder.path(), "wall-sweep-smoke");
    simulate(folder.path(), "board-distances-smoke");
    std::fs::write(path("room.toml"), ROOM).unwrap();
    let (room, camera) = (path("room"), path("CAMERA.json"));
    run(&[&"simulate", &path("room.toml"), &"-o", &room]);
    run(&[&"calibrate", &"--exposure-sweep", &wall, &"--distance-sweep", &board, &"-o", &camera]);
    let report = run(&[&"evaluate", &room, &"-c", &camera, &"--method", &"paper", &"--json"]);
    let report: serde_json::Value = serde_json::from_str(&report).unwrap();
    let figure = |when: &str, path: &str| -> f64 {
        let value = path.split('/').fold(&report["comparison"][when], |value, key| &value[key]);
        value.as_f64().unwrap_or_else(|| panic!("{when} {path}: {value}"))
    };
    let change = |path: &str| (figure("before", path), figure("after", path));
    for path in ["pixel_cv/median", "image_cv/cv", "histogram_distance/mean_ln", "otsu_shift/mean_ln"] {
        let (before, after) = change(path);
        assert!(after < 0.5 * before, "{path}: {before} {after}");
    }
    for path in ["threshold_iou/minimum", "threshold_iou/mean"] {
        let (before, after) = change(path);
        assert!(after > before + 0.1, "{path}: {before} {after}");
    }
    let (before, after) = change("distance_slope/slope");
    assert!(before < 0.0 && after.abs() < before.abs(), "slope {before} {after}");
    assert!(figure("after", "valid_fraction") > 0.95);
}
