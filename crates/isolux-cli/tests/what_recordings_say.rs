//! Recordings that do not say what they are: codes that nothing names, other units, another camera's calibration, streams
//! that were corrected already, nothing but noise. Each is told with the field to write or the thing to do, in `info`
//! and wherever something is computed from it; with the field written, the result is right.
#![allow(clippy::unwrap_used, clippy::panic, reason = "tests fail by panicking")]

mod common;

use common::{Array, Channels, Noise, Sandbox, calibration, mask, standardize};

const HEIGHT: usize = 48;
const WIDTH: usize = 64;
const PIXELS: usize = HEIGHT * WIDTH;
const FRAMES: usize = 4;
/// What `info` writes above its suspicions.
const DOUBTS: &str = "what looks wrong";

/// A checkered wall that goes away to the right, from 0.4 to 3 m; every frame in the order of its pixels.
fn distances_m() -> Vec<f64> {
    (0..FRAMES * PIXELS).map(|at| 0.4 + 2.6 * (at % WIDTH) as f64 / 63.0).collect()
}

fn amplitudes(gain: f64) -> Vec<f64> {
    let mut noise = Noise(5);
    let reflectivity =
        |at: usize| if (at % WIDTH / 8 + at / WIDTH % HEIGHT / 8).is_multiple_of(2) { 0.8 } else { 0.25 };
    let clean = distances_m().into_iter().enumerate().map(|(at, d)| gain * reflectivity(at) / (d * d));
    clean.map(|dn| (dn + 2.0 * noise.next()).round().max(1.0)).collect()
}

fn recording(amplitude: (&str, Vec<f64>), distance: (&str, Vec<f64>)) -> Channels {
    let dims = [FRAMES, HEIGHT, WIDTH];
    vec![
        ("amplitude", Array::new(amplitude.0, &dims, amplitude.1)),
        ("distance", Array::new(distance.0, &dims, distance.1)),
    ]
}

/// Amplitudes as u16 and distances in whole millimetres.
fn plain() -> Channels {
    let millimetres = distances_m().into_iter().map(|d| (1000.0 * d).round()).collect();
    recording(("<u2", amplitudes(1200.0)), ("<u2", millimetres))
}

/// The recording `rec` with this description.
fn described(channels: &Channels, json: &str) -> Sandbox {
    let sandbox = Sandbox::new();
    sandbox.described("rec", channels, json);
    sandbox
}

/// `info`, `standardize` and `calibrate --target` say this; nothing else looks wrong.
fn told(sandbox: &Sandbox, parts: &[&str]) {
    for part in parts {
        let info = sandbox.run("info rec").done().prints(part).prints(DOUBTS);
        let found = info.stdout.lines().skip_while(|line| *line != DOUBTS).skip(1);
        assert_eq!(found.take_while(|line| *line != "what can be done").count(), 1, "{info:?}");
        sandbox.run("standardize rec -o told --force").done().remarks(part);
    }
    let json = sandbox.run("info rec --json").json();
    assert_eq!(json["suspicions"].as_array().unwrap().len(), 1);
}

fn silent(sandbox: &Sandbox) {
    let info = sandbox.run("info rec").done();
    assert!(!info.stdout.contains(DOUBTS), "{info:?}");
    let run = sandbox.run("standardize rec -o silent --force").done();
    assert!(!run.stderr.contains("warning:"), "{run:?}");
}

/// The standardized values of this recording, as they should be.
fn right() -> Vec<f32> {
    standardize(&described(&plain(), "{}"), "--specular none").0
}

/// Largest relative difference of the values that both have.
fn largest_difference(a: &[f32], b: &[f32]) -> f32 {
    a.iter().zip(b).map(|(a, b)| (a / b - 1.0).abs()).filter(|d| d.is_finite()).fold(0.0, f32::max)
}

#[test]
fn a_clean_recording_raises_no_suspicion() {
    silent(&described(&plain(), "{}"));
    silent(&described(&plain(), r#"{"integration_time_us": 1000, "modulation_frequency_hz": 2e7}"#));
}

#[test]
fn codes_of_the_amplitude_are_told_and_once_named_are_saturated() {
    for (code, descr) in [(65535.0, "<u2"), (4095.0, "<f4"), (100_000.0, "<i4")] {
        let mut channels = plain();
        channels[0].1 = Array { descr: descr.to_owned(), ..channels[0].1.clone() };
        let saturated = |at: usize| at % PIXELS < 50;
        for (at, value) in channels[0].1.values.iter_mut().enumerate() {
            *value = if saturated(at) { code } else { (0.4 * *value).round() };
        }
        let field = format!("\"saturated_amplitude\": {code}");
        told(&described(&channels, "{}"), &[&field, "1.63 % of the amplitudes are exactly"]);
        for json in
            [format!("{{{field}}}"), format!("{{\"codes\": {{\"amplitude\": {{\"saturated\": {code}}}}}}}")]
        {
            let sandbox = described(&channels, &json);
            silent(&sandbox);
            let (_, flags) = standardize(&sandbox, "");
            let both = mask(&sandbox, "SATURATED") | mask(&sandbox, "INVALID");
            assert!(flags.iter().enumerate().all(|(at, flags)| (flags & both == both) == saturated(at)));
        }
    }
}

#[test]
fn a_clip_is_told() {
    for clip in [1000.0, 255.0] {
        let mut channels = plain();
        channels[0].1.values.iter_mut().for_each(|value| *value = value.min(clip));
        told(&described(&channels, "{}"), &[&format!("clipped at {clip}"), "\"saturated_amplitude\""]);
    }
}

#[test]
fn codes_of_the_distance_are_told_and_once_named_are_invalid() {
    for code in [8190.0, 65535.0, 20.0] {
        let mut channels = plain();
        let coded = |at: usize| at % 20 == 7;
        for (at, value) in channels[1].1.values.iter_mut().enumerate() {
            *value = if coded(at) { code } else { *value };
        }
        let json = format!("{{\"codes\": {{\"distance\": {{\"invalid\": {code}}}}}}}");
        told(&described(&channels, "{}"), &[&json[1..json.len() - 1], "of the distances are exactly"]);
        let sandbox = described(&channels, &json);
        silent(&sandbox);
        let (values, _) = standardize(&sandbox, "--specular none");
        assert!(values.iter().enumerate().all(|(at, value)| value.is_nan() == coded(at)));
    }
    let mut channels = plain();
    channels[1].1.values.iter_mut().step_by(9).for_each(|value| *value = 5000.0);
    channels[1].1.values.iter_mut().skip(4).step_by(9).for_each(|value| *value = 4990.0);
    let sandbox =
        described(&channels, r#"{"codes": {"distance": {"too_dark": [4990], "saturated": {"from": 4995}}}}"#);
    let (_, flags) = standardize(&sandbox, "");
    let count = |flag| flags.iter().filter(|flags| *flags & mask(&sandbox, flag) != 0).count();
    assert_eq!([count("SATURATED"), count("LOW_SIGNAL")], [1366, 1365]);
}

#[test]
fn distances_in_another_unit_are_told_and_with_the_unit_are_right() {
    let scaled = |descr, factor: f64| {
        let distance = distances_m().into_iter().map(|d| (1000.0 * d).round() / 1000.0 * factor).collect();
        recording(("<u2", amplitudes(1200.0)), (descr, distance))
    };
    for (descr, factor, field) in
        [("<f4", 1000.0, "\"distance_unit\": \"mm\""), ("<f8", 100.0, "\"distance_unit\": 0.01")]
    {
        told(&described(&scaled(descr, factor), "{}"), &[field, "look like"]);
        let sandbox = described(&scaled(descr, factor), &format!("{{{field}}}"));
        silent(&sandbox);
        // Both distances are rounded to f32, and squared.
        let difference = largest_difference(&standardize(&sandbox, "--specular none").0, &right());
        assert!(difference < 8.0 * f32::EPSILON, "{difference}");
    }
    let centimetres = distances_m().into_iter().map(|d| (100.0 * d).round()).collect();
    let channels = recording(("<u2", amplitudes(1200.0)), ("<u2", centimetres));
    told(&described(&channels, "{}"), &["\"distance_unit\": 0.01", "look like centimetres"]);
}

#[test]
fn any_unit_can_be_stated() {
    let quarters = distances_m().into_iter().map(|d| 4.0 * (1000.0 * d).round()).collect();
    let channels = recording(("<u2", amplitudes(1200.0)), ("<u2", quarters));
    let sandbox = described(&channels, r#"{"distance_unit": 0.00025}"#);
    let difference = largest_difference(&standardize(&sandbox, "--specular none").0, &right());
    assert!(difference < 8.0 * f32::EPSILON, "{difference}");
}

#[test]
fn distances_beyond_the_range_are_told() {
    let json = r#"{"modulation_frequency_hz": 8e7, "distance_unit": "mm"}"#;
    told(&described(&plain(), json), &["beyond 1.87 m", "\"modulation_frequency_hz\""]);
}

#[test]
fn times_in_another_unit_are_told() {
    for (times, unit, factor) in [
        ([0.2, 0.4, 0.8, 1.6], "milliseconds", "by 1000"),
        ([0.0002, 0.0004, 0.0008, 0.0016], "seconds", "by 1000000"),
    ] {
        let mut channels = plain();
        for (frame, values) in channels[0].1.values.chunks_mut(PIXELS).enumerate() {
            values.iter_mut().for_each(|value| *value *= times[frame] / times[0]);
        }
        channels.push(("integration_time_us", Array::of("<f8", &[FRAMES], &times)));
        told(&described(&channels, "{}"), &[unit, factor]);
    }
}

#[test]
fn intrinsics_of_another_resolution_are_told() {
    let at = |cx: f64, cy: f64| {
        format!("{{\"intrinsics\": {{\"fx\": 100, \"fy\": 100, \"cx\": {cx}, \"cy\": {cy}}}}}")
    };
    told(&described(&plain(), &at(63.5, 47.5)), &["principal point", "scale \"intrinsics\""]);
    silent(&described(&plain(), &at(30.0, 25.0)));
}

#[test]
fn a_stream_whose_times_are_corrected_keeps_its_values() {
    let mut channels = plain();
    channels.push(("integration_time_us", Array::of("<f8", &[FRAMES], &[500.0, 1000.0, 2000.0, 4000.0])));
    let sandbox = described(&channels, "{}");
    told(&sandbox, &["corrected for already"]);
    let run = sandbox.run("standardize rec -o out --force --specular none").done();
    run.remarks("the amplitudes no longer depend on the integration time: this step is left out");
    // Asked for by name, it is done.
    sandbox.run("standardize rec -o out --force --time linear").done().prints("time: linear");
}

#[test]
fn a_gamma_curve_is_told() {
    for exponent in [0.5, 1.0 / 2.2] {
        let mut channels = plain();
        let times = [500.0, 1000.0, 2000.0, 4000.0];
        for (frame, values) in channels[0].1.values.chunks_mut(PIXELS).enumerate() {
            values
                .iter_mut()
                .for_each(|value| *value = (*value * times[frame] / 10.0).powf(exponent).round());
        }
        channels.push(("integration_time_us", Array::of("<f8", &[FRAMES], &times)));
        told(&described(&channels, "{}"), &["a gamma curve", "isolux diagnose"]);
    }
}

#[test]
fn what_was_standardized_is_not_corrected_again() {
    let sandbox = described(&plain(), r#"{"integration_time_us": 1000}"#);
    let (first, _) = standardize(&sandbox, "--specular none");
    let dims = [FRAMES, HEIGHT, WIDTH];
    let mut again = plain();
    again[0].1 = Array::new("<f4", &dims, first.iter().map(|value| f64::from(*value)).collect());
    let json = std::fs::read_to_string(sandbox.join("out/recording.json")).unwrap();
    let sandbox = described(&again, &json);
    told(&sandbox, &["have been standardized"]);
    let (second, _) = standardize(&sandbox, "--specular none");
    assert_eq!(largest_difference(&second, &first), 0.0);
    // With its input, the amplitude is still the recorded one.
    let sandbox = described(&plain(), "{}");
    sandbox.run("standardize rec -o kept --keep-input").done();
    let info = sandbox.run("info kept").done();
    assert!(!info.stdout.contains(DOUBTS), "{info:?}");
}

#[test]
fn nothing_but_noise_is_told_and_flagged_where_sigma_is_predicted() {
    let mut noise = Noise(11);
    let dark = (0..FRAMES * PIXELS).map(|_| noise.next().hypot(noise.next()) * 4.0).collect();
    let distance = (0..FRAMES * PIXELS).map(|_| 6.0).collect();
    let sandbox = described(&recording(("<f4", dark), ("<f4", distance)), r#"{"integration_time_us": 100}"#);
    told(&sandbox, &["little more than noise"]);
    let read = "--sigma on --read-noise-dn 4 --shot-noise-dn2-per-dn 0";
    let (_, flags) = standardize(&sandbox, read);
    let low = mask(&sandbox, "LOW_SIGNAL");
    let share = flags.iter().filter(|flags| *flags & low != 0).count() as f64 / flags.len() as f64;
    // Rayleigh's distribution exceeds five of its parameter once in 270 000.
    assert!(share > 0.999, "{share}");
}

#[test]
fn the_calibration_of_another_camera_is_told() {
    let sandbox = described(&plain(), r#"{"camera": "Y", "integration_time_us": 2000}"#);
    sandbox.write("camera.json", calibration().to_string());
    let run = sandbox.run("standardize rec -c camera.json -o out").done();
    run.remarks("warning: the calibration is that of `X`, the recording is from `Y`");
    let sandbox = described(&plain(), r#"{"camera": "x", "integration_time_us": 2000}"#);
    sandbox.write("camera.json", calibration().to_string());
    let run = sandbox.run("standardize rec -c camera.json -o out").done();
    assert!(!run.stderr.contains("recording is from"), "{run:?}");
}

#[test]
fn a_summary_counts_what_was_extrapolated() {
    let far = distances_m().into_iter().map(|d| 1000.0 * (d + 4.0)).collect();
    let channels = recording(("<u2", amplitudes(20000.0)), ("<u2", far));
    let sandbox = described(&channels, r#"{"integration_time_us": 2000}"#);
    sandbox.write("camera.json", calibration().to_string());
    let run = sandbox.run("standardize rec -c camera.json -o out").done();
    run.prints("no pixel within the calibrated ranges; 100.00 % have a value, which is extrapolated");
}

#[test]
fn the_reference_time_lies_in_the_sweep_unless_it_is_asked_for() {
    let times = [100.0, 200.0, 400.0, 800.0];
    let mut channels = plain();
    for (frame, values) in channels[0].1.values.chunks_mut(PIXELS).enumerate() {
        values.iter_mut().for_each(|value| *value = (*value * times[frame] / 100.0).round());
    }
    channels.push(("integration_time_us", Array::of("<f8", &[FRAMES], &times)));
    let sandbox = described(&channels, "{}");
    sandbox.run("info rec").done().prints("--reference-time-us");
    sandbox.run("calibrate --exposure-sweep rec -o camera.json").done();
    assert_eq!(sandbox.json("camera.json")["reference"]["integration_time_us"], 800.0);
    sandbox.run("calibrate --exposure-sweep rec -o other.json --reference-time-us 300").done();
    assert_eq!(sandbox.json("other.json")["reference"]["integration_time_us"], 300.0);
    let beyond = "calibrate --exposure-sweep rec -o none.json --reference-time-us 8200";
    sandbox.run(beyond).refused(1, &["reference time of 8200", "--reference-time-us 800"]);
}
