//! Recordings whose exposure is not known: automatic and unrecorded, or scaled frame by frame. Every command says so,
//! no fit takes such frames for one exposure, and what still pixels share can be taken out.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "tests fail by panicking")]

mod common;

use common::{Array, Channels, Noise, Sandbox};
use serde_json::Value;

const HEIGHT: usize = 48;
const WIDTH: usize = 64;
const PIXELS: usize = HEIGHT * WIDTH;
/// Standard deviation of an amplitude, DN.
const NOISE_DN: f64 = 3.0;
const INTRINSICS: &str = "\"intrinsics\": {\"fx\": 60.0, \"fy\": 60.0, \"cx\": 31.5, \"cy\": 23.5}";
/// Words of the remark about a common factor, and of that about stretched frames.
const CHANGED: &str = "all still pixels share a factor from frame to frame";
const SCALED: &str = "scaled frame by frame";

/// A slanted wall of three materials. The pattern and the distances shift by `moved` columns with each frame.
fn wall(frame: usize, pixel: usize, moved: usize) -> (f64, f64) {
    let (row, column) = (pixel / WIDTH, pixel % WIDTH + moved * frame);
    let distance_m = 1.0 + 1.5 * (column % 128) as f64 / 63.0;
    let reflectivity = 0.1 + 0.4 * ((row / 12 + column / 16) % 3) as f64;
    (800.0 * reflectivity / distance_m.powi(2), distance_m)
}

/// Amplitudes of `gains.len()` frames as `dtype`, and distances.
fn recorded(gains: &[f64], moved: usize) -> (Vec<f64>, Vec<f64>) {
    let mut noise = Noise(7);
    let pixels =
        || gains.iter().enumerate().flat_map(|(frame, gain)| (0..PIXELS).map(move |p| (frame, *gain, p)));
    let amplitude =
        pixels().map(|(frame, gain, pixel)| gain * wall(frame, pixel, moved).0 + NOISE_DN * noise.next());
    let amplitude = amplitude.map(|dn| dn.round().max(0.0)).collect();
    (amplitude, pixels().map(|(frame, _, pixel)| wall(frame, pixel, moved).1).collect())
}

fn channels(amplitude: (&str, Vec<f64>), distance: Vec<f64>) -> Channels {
    let shape = [distance.len() / PIXELS, HEIGHT, WIDTH];
    vec![
        ("amplitude", Array::new(amplitude.0, &shape, amplitude.1)),
        ("distance", Array::new("<f4", &shape, distance)),
    ]
}

/// A still wall whose exposure changes by these gains, without times.
fn still(gains: &[f64]) -> Channels {
    let (amplitude, distance) = recorded(gains, 0);
    channels(("<u2", amplitude), distance)
}

/// Each frame stretched to 0..`full`, in steps of `step`.
fn stretched(amplitude: &mut [f64], full: f64, step: f64) {
    for frame in amplitude.chunks_mut(PIXELS) {
        let (low, high) = frame.iter().fold((f64::MAX, f64::MIN), |(l, h), v| (l.min(*v), h.max(*v)));
        frame.iter_mut().for_each(|v| *v = ((*v - low) / (high - low) * full / step).trunc() * step);
    }
}

fn automatic() -> Vec<f64> {
    (0..40).map(|frame| (0.7 * (f64::from(frame) / 3.0).sin()).exp()).collect()
}

fn with_times(mut recording: Channels, times_us: Vec<f64>) -> Channels {
    recording.push(("integration_time_us", Array::new("<f8", &[times_us.len()], times_us)));
    recording
}

fn sandbox(recording: &Channels, json: &str) -> Sandbox {
    let sandbox = Sandbox::new();
    sandbox.described("rec", recording, json);
    sandbox
}

fn findings(sandbox: &Sandbox) -> Vec<Value> {
    let told = sandbox.run("diagnose rec --json").json();
    told["diagnosis"]["findings"].as_array().unwrap().clone()
}

fn finding(sandbox: &Sandbox, name: &str) -> Option<Value> {
    findings(sandbox).into_iter().find(|finding| finding["finding"] == name)
}

/// Largest over smallest median of a frame, less 1.
fn variation(values: &[f32]) -> f64 {
    let median = |frame: &[f32]| {
        let mut valid: Vec<f32> = frame.iter().copied().filter(|v| !v.is_nan()).collect();
        valid.sort_by(f32::total_cmp);
        f64::from(valid[valid.len() / 2])
    };
    let medians: Vec<f64> = values.chunks(PIXELS).map(median).collect();
    let mean = medians.iter().sum::<f64>() / medians.len() as f64;
    (medians.iter().map(|m| (m - mean).powi(2)).sum::<f64>() / medians.len() as f64).sqrt() / mean
}

#[test]
fn frames_that_were_stretched_one_by_one_are_noticed() {
    let gains: Vec<f64> = (0..20).map(|_| 1.0).collect();
    for (name, dtype, full, step) in
        [("8 bit", "|u1", 255.0, 1.0), ("float", "<f4", 1.0, 1e-9), ("16 bit", "<u2", 65535.0, 1.0)]
    {
        let (mut amplitude, distance) = recorded(&gains, 0);
        // A glint in every second frame is what the others are scaled by.
        amplitude.chunks_mut(PIXELS).step_by(2).for_each(|frame| frame[131] = 25000.0);
        stretched(&mut amplitude, full, step);
        let sandbox = sandbox(&channels((dtype, amplitude), distance), "{}");
        let span = format!("every frame spans exactly 0 to {full}");
        sandbox.run("info rec").done().prints(SCALED).prints(&span);
        sandbox.run("standardize rec -o out").done().remarks(SCALED);
        let told = finding(&sandbox, "scaled_by_frame").unwrap_or_else(|| panic!("{name}"));
        assert_eq!((&told["largest_dn"], &told["frames"]), (&full.into(), &20.into()), "{name}");
    }
}

#[test]
fn holes_and_a_saturation_code_are_no_stretch() {
    let gains = vec![1.0; 20];
    let (mut amplitude, distance) = recorded(&gains, 0);
    for frame in amplitude.chunks_mut(PIXELS) {
        frame[5] = 0.0;
        frame[700..703].fill(65535.0);
    }
    let sandbox = sandbox(&channels(("<u2", amplitude), distance), "{\"saturated_amplitude\": 65535}");
    assert!(findings(&sandbox).iter().all(|finding| finding["finding"] != "scaled_by_frame"));
    let info = sandbox.run("info rec").done();
    assert!(!info.stdout.contains(SCALED) && !info.stdout.contains(CHANGED), "{info:?}");
}

#[test]
fn an_exposure_that_changed_is_told_with_its_range() {
    let sandbox = sandbox(&still(&automatic()), "{}");
    sandbox.run("info rec").done().prints(CHANGED).prints("the integration times are not recorded");
    let told = finding(&sandbox, "exposure_changed").unwrap();
    // exp(±0.7) about the median frame, whose own gain is within a few per cent of 1.
    for (end, expected) in [("least", (-0.7f64).exp()), ("largest", 0.7f64.exp())] {
        assert!((told[end].as_f64().unwrap() / expected - 1.0).abs() < 0.1, "{told}");
    }
    let run = sandbox.run("calibrate --scene rec -o C.json");
    assert!((run.stdout.clone() + &run.stderr).contains("the integration times are not recorded"), "{run:?}");
}

#[test]
fn jumps_and_stated_times_that_do_not_explain_them_are_told() {
    let jump: Vec<f64> = (0..30).map(|frame| if frame < 17 { 1.0 } else { 0.6 }).collect();
    let one = sandbox(&still(&jump), "{\"integration_time_us\": 500}");
    one.run("info rec").done().prints(CHANGED).prints("states one integration time");
    assert_eq!(finding(&one, "exposure_changed").unwrap()["claim"], "constant");
    // Recorded times that alternate, and a gain that does not follow them.
    let times_us: Vec<f64> = (0..40).map(|frame| if frame % 4 < 2 { 500.0 } else { 1000.0 }).collect();
    let gains: Vec<f64> =
        automatic().iter().zip(&times_us).map(|(gain, time_us)| gain * time_us / 800.0).collect();
    let recorded = sandbox(&with_times(still(&gains), times_us.clone()), "{}");
    assert_eq!(finding(&recorded, "exposure_changed").unwrap()["claim"], "recorded");
    // The same times, and gains that follow them.
    let gains: Vec<f64> = times_us.iter().map(|time_us| time_us / 800.0).collect();
    let fine = sandbox(&with_times(still(&gains), times_us), "{}");
    assert_eq!(finding(&fine, "exposure_changed"), None);
    assert!(!fine.run("info rec").done().stdout.contains(CHANGED));
}

#[test]
fn movement_is_no_exposure() {
    let (amplitude, distance) = recorded(&[1.0; 20], 3);
    let sandbox = sandbox(&channels(("<u2", amplitude), distance), "{}");
    assert_eq!(finding(&sandbox, "exposure_changed"), None);
    assert!(!sandbox.run("info rec").done().stdout.contains(CHANGED));
    sandbox.run("standardize rec --time relative -o out").refused(1, &["too little stands still"]);
}

#[test]
fn relative_takes_the_factor_out_of_what_stands_still() {
    let sandbox = sandbox(&still(&automatic()), "{}");
    let raw: Vec<f32> = recorded(&automatic(), 0).0.into_iter().map(|dn| dn as f32).collect();
    assert!(variation(&raw) > 0.4);
    sandbox
        .run("standardize rec --time relative --distance none --specular none -o out")
        .done()
        .remarks("relative, not that of any integration time");
    // 3072 pixels of a noise of 2 % and less: the median is known to a thousandth, and rounding adds as much.
    assert!(variation(&sandbox.f32s("out/standardized_amplitude.npy")) < 0.01);
    let step = &sandbox.json("out/recording.json")["standardization"]["steps"][0];
    assert_eq!(step["term"], "relative");
    assert!(step["parameters"].as_str().unwrap().starts_with("relative, not absolute"));
}

#[test]
fn evaluate_tells_the_variation_from_frame_to_frame() {
    let sandbox = sandbox(&still(&automatic()), "{}");
    let name = "frame-to-frame variation of still pixels";
    sandbox.run("evaluate rec --report page.html").done().prints(name);
    assert!(std::fs::read_to_string(sandbox.join("page.html")).unwrap().contains(name));
    let of = |told: &Value| told["frame_to_frame"]["cv"].as_f64().unwrap();
    let json = sandbox.run("evaluate rec --time relative --json").json();
    let comparison = json.pointer("/comparison").or(json.pointer("/evaluation")).unwrap_or(&json);
    assert!(of(&comparison["before"]) > 0.4 && of(&comparison["after"]) < 0.01, "{json}");
}

/// A board that faces the camera at twelve distances, its median held by an automatic exposure.
fn board() -> Channels {
    let (mut amplitude, mut distance, mut noise) = (Vec::new(), Vec::new(), Noise(3));
    for frame in 0..60 {
        let at_m = 0.5 * 6f64.powf(f64::from(frame / 5) / 11.0);
        let gain = (400.0 / (360.0 / at_m.powi(2))).clamp(0.2, 3.0);
        for _ in 0..PIXELS {
            let distance_m = at_m + 0.003 * noise.next();
            distance.push(distance_m);
            amplitude.push((gain * 360.0 / distance_m.powi(2) + NOISE_DN * noise.next()).round());
        }
    }
    let shape = [60, HEIGHT, WIDTH];
    let mut board = channels(("<u2", amplitude), distance);
    board.push(("target", Array::filled("|u1", &shape, 1.0)));
    board
}

#[test]
fn no_law_over_distance_comes_from_a_board_at_unknown_times() {
    let sandbox = sandbox(&board(), &format!("{{{INTRINSICS}}}"));
    let reason = ["the integration times are not recorded", "any law would fit", "\"integration_time_us\""];
    sandbox.run("calibrate --distance-sweep rec -o C.json").refused(1, &reason);
    let run = sandbox.run("calibrate --target rec -o T.json");
    for part in reason {
        assert!((run.stdout.clone() + &run.stderr).contains(part), "{part}: {run:?}");
    }
    if run.code == Some(0) {
        assert!(sandbox.json("T.json")["terms"]["spline"].is_null(), "{run:?}");
    }
    // Whoever states one time is believed.
    sandbox.described("stated", &board(), &format!("{{\"integration_time_us\": 500, {INTRINSICS}}}"));
    sandbox.run("calibrate --distance-sweep stated -o S.json --reference-distance-m 1.5").done();
}
