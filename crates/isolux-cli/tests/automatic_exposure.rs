//! A camera that is carried through a room with automatic exposure: profile and angle come out as with known times, a law
//! over distance is refused.
#![allow(clippy::unwrap_used, clippy::panic, reason = "tests fail by panicking")]

mod common;

use common::{Array, Sandbox};

/// Frames of the scene, and pixels of the small camera.
const FRAMES: usize = 12;
const HEIGHT: usize = 72;
const WIDTH: usize = 88;

/// The room `room` with its times, and what is recorded of it with an automatic exposure: `automatic` without times, `own`
/// with a time for each frame, `stated` with one time for all.
fn recorded() -> Sandbox {
    let sandbox = Sandbox::new();
    let camera = isolux_camera::CameraModel::preset_toml("sr3100").unwrap();
    let small = [("144", "72"), ("176", "88"), ("200.0", "100.0"), ("87.5", "43.5"), ("71.5", "35.5")];
    let camera = small.into_iter().fold(camera.to_owned(), |text, (from, to)| {
        assert!(text.contains(&format!("= {from}")), "{from}");
        text.replace(&format!("= {from}"), &format!("= {to}"))
    });
    sandbox.write("small.toml", camera);
    sandbox.run("simulate hand-held-smoke -o room --camera small.toml").done();
    let amplitude = sandbox.f32s("room/amplitude.npy");
    let medians: Vec<f64> = amplitude.chunks(HEIGHT * WIDTH).map(median).collect();
    let mean = medians.iter().sum::<f64>() / medians.len() as f64;
    let held = amplitude
        .iter()
        .enumerate()
        .map(|(at, value)| f64::from(*value) * mean / medians[at / (HEIGHT * WIDTH)]);
    let held = Array::new("<f4", &[FRAMES, HEIGHT, WIDTH], held.collect());
    let times = (0..FRAMES).map(|frame| 1000.0 * 1.07f64.powi(frame as i32)).collect();
    let mut json = sandbox.json("room/recording.json");
    for name in ["automatic", "own", "stated"] {
        sandbox.recording(name, &[("amplitude", held.clone())]);
        for channel in ["distance.npy", "world_from_camera.npy"] {
            let bytes = std::fs::read(sandbox.join(&format!("room/{channel}"))).unwrap();
            sandbox.write(&format!("{name}/{channel}"), bytes);
        }
        sandbox.write(&format!("{name}/recording.json"), json.to_string());
    }
    sandbox.write("own/integration_time_us.npy", Array::new("<f8", &[FRAMES], times).bytes());
    json["integration_time_us"] = 8200.into();
    sandbox.write("stated/recording.json", json.to_string());
    sandbox
}

fn median(values: &[f32]) -> f64 {
    let mut valid: Vec<f32> = values.iter().copied().filter(|value| *value > 0.0).collect();
    valid.sort_unstable_by(f32::total_cmp);
    f64::from(valid[valid.len() / 2])
}

/// Exponent of the angle, and the profile at nine places of the image.
fn fitted(sandbox: &Sandbox, name: &str) -> (f64, Vec<f64>) {
    let run = sandbox.run(&format!("calibrate --scene {name} -o {name}.json")).done();
    let at = run.stdout.lines().skip_while(|line| !line.starts_with("profile,")).skip(1);
    let places = at.take(3).flat_map(str::split_whitespace).map(|value| value.parse().unwrap()).collect();
    (sandbox.json(&format!("{name}.json"))["terms"]["angle"]["exponent"].as_f64().unwrap(), places)
}

#[test]
fn profile_and_angle_need_no_times_and_the_law_is_refused() {
    let sandbox = recorded();
    let (exponent, profile) = fitted(&sandbox, "room");
    assert!(!sandbox.json("room.json")["terms"]["spline"].is_null());
    for name in ["automatic", "own", "stated"] {
        let (found, places) = fitted(&sandbox, name);
        // The same noise: what differs is the weight of what distances alone would tell.
        assert!((found - exponent).abs() < 0.02, "{name}: {found} {exponent}");
        for (place, with_times) in places.iter().zip(&profile) {
            assert!((place / with_times - 1.0).abs() < 0.01, "{name}: {places:?} {profile:?}");
        }
        assert!(sandbox.json(&format!("{name}.json"))["terms"]["spline"].is_null(), "{name}");
    }
    let refused = "each distance was recorded";
    sandbox
        .run("calibrate --scene automatic -o again.json")
        .remarks("\"integration_time_us\"")
        .remarks(refused);
    let stated =
        sandbox.run("calibrate --scene stated -o again.json").remarks("do not explain").remarks(refused);
    assert!(stated.stdout.starts_with("usable: "), "{stated:?}");
}
