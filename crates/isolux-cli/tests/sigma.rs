//! Predicted standard deviations and merged brackets, through the program.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "tests fail by panicking")]

mod common;

use common::{Array, Channels, Sandbox, bits, mask, sweep, with, without};

const SIGMA: &str = "out/sigma.npy";
const NOISE: &str = "--read-noise-dn 3 --shot-noise-dn2-per-dn 0.5 --modulation-frequency-hz 20e6";

/// A still scene in brackets of four times, of which the last one is saturated in its first pixel.
fn brackets(count: usize) -> Channels {
    let sweep = sweep();
    let repeat = |name: &str| {
        let array = common::get(&sweep, name);
        let values: Vec<f64> = (0..count).flat_map(|_| array.values.clone()).collect();
        let mut dims = array.dims.clone();
        dims[0] *= count;
        Array::new(&array.descr, &dims, values)
    };
    let mut amplitude = repeat("amplitude");
    let pixels = amplitude.dims[1] * amplitude.dims[2];
    for bracket in 0..count {
        amplitude.values[(4 * bracket + 3) * pixels] = 60_000.0;
    }
    vec![
        ("amplitude", amplitude),
        ("distance", repeat("distance")),
        ("integration_time_us", repeat("integration_time_us")),
    ]
}

#[test]
fn sigma_is_written_where_the_noise_is_known_and_only_there() {
    let sandbox = Sandbox::new();
    sandbox.recording("rec", &sweep());
    sandbox.run("standardize rec -o out").done();
    assert!(!sandbox.join(SIGMA).exists());
    sandbox
        .run(&format!("standardize rec -o out --force --specular none --time none --distance none {NOISE}"))
        .done();
    let (values, sigma) = (sandbox.f32s("out/standardized_amplitude.npy"), sandbox.f32s(SIGMA));
    for (value, sigma) in values.iter().zip(&sigma) {
        // One square root of three roundings.
        let expected = (9.0 + 0.5 * f64::from(*value)).sqrt();
        assert!((f64::from(*sigma) / expected - 1.0).abs() < 4.0 * f64::from(f32::EPSILON));
    }
    let steps = sandbox.json("out/recording.json")["standardization"]["steps"].clone();
    assert_eq!(steps.as_array().unwrap().last().unwrap()["effect"], "sigma");
    sandbox.run("standardize rec -o out --force --sigma off").done();
    assert!(!sandbox.join(SIGMA).exists());
    sandbox.run("info out").done().prints("standardized_amplitude");
}

#[test]
fn values_without_sigma_are_nan_in_both_and_threads_do_not_matter() {
    let sandbox = Sandbox::new();
    let mut channels = sweep();
    channels[0].1.values[3] = 0.0;
    sandbox.recording("rec", &channels);
    let run = |threads: u8| {
        let denoise = "--denoise temporal";
        sandbox.run(&format!("standardize rec -o out --force {NOISE} {denoise} --threads {threads}")).done();
        (sandbox.f32s("out/standardized_amplitude.npy"), sandbox.f32s(SIGMA))
    };
    let (values, sigma) = run(1);
    assert!(values.iter().zip(&sigma).all(|(value, sigma)| value.is_nan() == sigma.is_nan()));
    assert!(values[3].is_nan() && sigma.iter().filter(|sigma| !sigma.is_nan()).all(|sigma| *sigma > 0.0));
    let many = run(8);
    assert_eq!((bits(&values), bits(&sigma)), (bits(&many.0), bits(&many.1)));
}

#[test]
fn a_simulated_sweep_tells_the_noise_and_evaluate_the_coverage() {
    let sandbox = Sandbox::new();
    sandbox.run("simulate wall-sweep-smoke -o wall").done();
    let calibration = sandbox.run("calibrate --exposure-sweep wall -o camera.json --json").json();
    let noise = &calibration["terms"]["noise"];
    // The SR-3100: 0.16 DN per electron, read noise 120 electrons.
    let truth = [0.5 * ((0.16f64 * 120.0).powi(2) + 1.0 / 12.0), 0.08];
    for (name, truth) in ["read_variance_dn2", "shot_variance_dn2_per_dn"].iter().zip(truth) {
        let found = noise["by_intensity"][name].as_f64().unwrap();
        // As in the core's own test: trimmed variances of two frames, slightly compressed.
        assert!((found / truth - 1.0).abs() < 0.1, "{name}: {found} {truth}");
    }
    let options = "wall -c camera.json --distance none --specular none --trusted";
    let coverage = |more: &str| {
        let evaluation = sandbox.run(&format!("evaluate {options} {more} --json")).json();
        evaluation["comparison"]["after"]["sigma_coverage"].clone()
    };
    // One error in two frames of 24 times and 25 000 pixels: chance is far below 1 %.
    let of_calibration = coverage("")["within_one_sigma"].as_f64().unwrap();
    assert!((0.66..=0.70).contains(&of_calibration), "{of_calibration}");
    let off = coverage("--sigma off");
    assert_eq!(off["unavailable"], "no_sigma");
    sandbox.run(&format!("evaluate {options}")).done().prints("errors within one predicted sigma");
    // Without a calibration, from the recording itself.
    let own =
        sandbox.run("evaluate wall --distance none --time linear --specular none --sigma on --json").json();
    let own = own["comparison"]["after"]["sigma_coverage"]["within_one_sigma"].as_f64().unwrap();
    assert!((0.6..=0.76).contains(&own), "{own}");
}

#[test]
fn noise_options_are_checked() {
    let sandbox = Sandbox::new();
    sandbox.recording("rec", &sweep());
    let before = sandbox.snapshot();
    for (options, code, part) in [
        ("--read-noise-dn=-1", 2, "0 or more"),
        ("--read-noise-dn 0", 2, "no noise at all"),
        ("--sigma off --read-noise-dn 1", 2, "--sigma off"),
        ("--sigma maybe", 2, "maybe"),
        ("--modulation-frequency-hz 0", 2, "positive"),
        ("--merge-bracket", 2, "--sigma on"),
        ("--merge-bracket=1", 2, "1"),
        ("--merge-bracket --keep-input", 2, "cannot be used with"),
    ] {
        sandbox.run(&format!("standardize rec -o out {options}")).refused(code, &[part]);
        sandbox.expect_unchanged(&before, options);
    }
    // Amplitudes in proportion to the time, no two frames alike, no noise in space.
    let flat = with(&sweep(), "amplitude", Array::filled("<f4", &[4, 5, 6], 20.0));
    sandbox.recording("flat", &flat);
    sandbox.run("standardize flat -o out --sigma on").refused(1, &["--read-noise-dn"]);
}

#[test]
fn a_bracket_ends_where_a_time_recurs() {
    let sandbox = Sandbox::new();
    let json = r#"{"saturated_amplitude": 60000}"#;
    sandbox.described("rec", &brackets(3), json);
    for (option, frames) in [("--merge-bracket", 3), ("--merge-bracket=6", 2), ("--merge-bracket=5", 3)] {
        let options = format!("standardize rec -o out --force --specular none {NOISE} {option} --json");
        let printed = sandbox.run(&options).json();
        assert_eq!(printed["summary"]["frames"], frames);
        assert_eq!(printed["steps"].as_array().unwrap().iter().filter(|s| s["effect"] == "merge").count(), 1);
        assert!(sandbox.array("out/sigma.npy").0.contains(&format!("({frames}, 5, 6")));
    }
    assert!(!sandbox.join("out/integration_time_us.npy").exists());
}

#[test]
fn merged_frames_are_less_noisy_filled_and_the_same_on_any_number_of_threads() {
    let sandbox = Sandbox::new();
    sandbox.described("rec", &brackets(3), r#"{"saturated_amplitude": 60000}"#);
    let options = format!("--specular none --time linear --distance square {NOISE}");
    sandbox.run(&format!("standardize rec -o single {options}")).done();
    let single = (sandbox.f32s("single/standardized_amplitude.npy"), sandbox.f32s("single/sigma.npy"));
    let merged = |threads: u8| {
        sandbox
            .run(&format!("standardize rec -o out --force {options} --merge-bracket --threads {threads}"))
            .done();
        (sandbox.f32s("out/standardized_amplitude.npy"), sandbox.f32s(SIGMA))
    };
    let (values, sigma) = merged(1);
    let many = merged(7);
    assert_eq!((bits(&values), bits(&sigma)), (bits(&many.0), bits(&many.1)));
    let invalid = mask(&sandbox, "INVALID");
    assert!(sandbox.u16s("out/flags.npy").iter().all(|flags| flags & invalid == 0));
    for pixel in 0..30 {
        let of = |frame: usize| (single.0[30 * frame + pixel], single.1[30 * frame + pixel]);
        let known: Vec<_> = (0..4).map(of).filter(|(value, _)| !value.is_nan()).collect();
        assert_eq!(known.len(), if pixel == 0 { 3 } else { 4 });
        let best = known.iter().map(|(_, sigma)| *sigma).fold(f32::INFINITY, f32::min);
        assert!(sigma[pixel] < best, "{pixel}: {} {best}", sigma[pixel]);
        let (low, high) =
            known.iter().fold((f32::INFINITY, 0f32), |(low, high), (v, _)| (low.min(*v), high.max(*v)));
        assert!((low..=high).contains(&values[pixel]), "{pixel}");
    }
}

#[test]
fn what_makes_no_bracket_is_refused_with_the_way_out() {
    let sandbox = Sandbox::new();
    let constant = with(&sweep(), "integration_time_us", Array::filled("<f8", &[4], 1000.0));
    sandbox.recording("constant", &constant);
    sandbox.recording("timeless", &without(&sweep(), "integration_time_us"));
    let maps = with(&sweep(), "integration_time_us", Array::filled("<f4", &[4, 5, 6], 1000.0));
    sandbox.recording("maps", &maps);
    for rec in ["constant", "timeless", "maps"] {
        sandbox
            .run(&format!("standardize {rec} -o out --merge-bracket {NOISE}"))
            .refused(2, &["--merge-bracket=N"]);
        sandbox.run(&format!("standardize {rec} -o out --force --merge-bracket=2 {NOISE}")).done();
    }
}
