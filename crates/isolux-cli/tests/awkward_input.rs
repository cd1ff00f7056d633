//! Awkward but good input: it works, and the results are those of the plain recording wherever they must be.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "tests fail by panicking")]

mod common;

use common::{Array, Channels, Sandbox, bits, get, mask, npz, standardize, sweep, with, without};
use zip::CompressionMethod::{Deflated, Stored};

/// What the channels make when they lie in a folder.
fn of(channels: &[(&str, Array)], options: &str) -> (Vec<f32>, Vec<u16>) {
    let sandbox = Sandbox::new();
    sandbox.recording("rec", channels);
    standardize(&sandbox, options)
}

fn expect_same(found: &(Vec<f32>, Vec<u16>), expected: &(Vec<f32>, Vec<u16>), what: &str) {
    assert_eq!(bits(&found.0), bits(&expected.0), "{what}");
    assert_eq!(found.1, expected.1, "{what}");
}

/// Every command that reads must do with this.
fn every_reader_works(sandbox: &Sandbox) {
    sandbox.run("info rec").done().prints("frames");
    assert!(sandbox.run("info rec --json").json()["frames"].is_u64());
    sandbox.run("evaluate rec").done();
    assert!(sandbox.run("evaluate rec --json").json().is_object());
    standardize(sandbox, "");
    standardize(sandbox, "--specular sigma");
    standardize(sandbox, "--specular percent");
    standardize(sandbox, "--specular knee");
    standardize(sandbox, "--read-noise-dn 1");
}

#[test]
fn the_same_values_in_every_form_give_the_same_bits() {
    let plain = sweep();
    let expected = of(&plain, "");
    assert!(expected.1.iter().all(|flags| *flags & 1 == 0));
    let (amplitude, distance) = (get(&plain, "amplitude"), get(&plain, "distance"));
    let times = get(&plain, "integration_time_us");
    let forms: [(&str, Channels); 10] = [
        ("u8 amplitude", with(&plain, "amplitude", amplitude.to("|u1"))),
        ("u16 amplitude, big-endian", with(&plain, "amplitude", amplitude.to(">u2"))),
        ("f64 amplitude, big-endian", with(&plain, "amplitude", amplitude.to(">f8"))),
        ("f64 distance", with(&plain, "distance", distance.to("<f8"))),
        ("distance in mm", with(&plain, "distance", distance.times(1000.0).to("<u2"))),
        ("distance in mm, i4, big-endian", with(&plain, "distance", distance.times(1000.0).to(">i4"))),
        ("u2 times, big-endian", with(&plain, "integration_time_us", times.to(">u2"))),
        ("Fortran order", with(&plain, "amplitude", amplitude.fortran())),
        ("Fortran order, big-endian", with(&plain, "amplitude", amplitude.to(">u2").fortran())),
        ("everything at once", {
            let all = with(&plain, "amplitude", amplitude.to(">f8").fortran());
            with(&all, "distance", distance.times(1000.0).to(">i4").fortran())
        }),
    ];
    for (what, channels) in forms {
        expect_same(&of(&channels, ""), &expected, what);
        for method in [Stored, Deflated] {
            let sandbox = Sandbox::new();
            sandbox.write("rec/recording.npz", npz(&channels, method));
            expect_same(&standardize(&sandbox, ""), &expected, &format!("{what}, {method}"));
        }
    }
}

#[test]
fn archives_are_read_and_written_beside_their_description() {
    let expected = of(&sweep(), "");
    for method in [Stored, Deflated] {
        let sandbox = Sandbox::new();
        sandbox.write("rec.npz", npz(&sweep(), method));
        sandbox.write("rec.json", "{\"camera\": \"X\", \"site\": {\"room\": 7}}");
        sandbox.run("standardize rec.npz -o out.npz --keep-input").done();
        assert_eq!(sandbox.json("out.json")["site"]["room"], 7);
        // The archive as a recording of its own, standardized again: amplitude is as it was.
        sandbox.run("standardize out.npz -o again").done();
        assert_eq!(bits(&sandbox.f32s("again/standardized_amplitude.npy")), bits(&expected.0));
    }
}

#[test]
fn invalid_pixels_are_flagged_and_their_neighbours_untouched() {
    let plain = sweep();
    let clean = of(&plain, "--specular none");
    let spoilt = |name: &'static str, values: &[(usize, f64)]| {
        let mut array = get(&plain, name).clone();
        values.iter().for_each(|(at, value)| array.values[*at] = *value);
        with(&plain, name, array)
    };
    let bad_values = [(0, f64::NAN), (7, 0.0), (13, -3.0), (59, f64::INFINITY), (119, f64::NEG_INFINITY)];
    let times = Array::new("<f4", &[4, 5, 6], (0..120).map(|i| f64::from(i / 30 + 1) * 1000.0).collect());
    let mut unknown = times.clone();
    (unknown.values[7], unknown.values[119]) = (0.0, f64::NAN);
    let cases = [
        ("amplitude", spoilt("amplitude", &bad_values), vec![0, 7, 13, 59, 119]),
        ("distance", spoilt("distance", &bad_values), vec![0, 7, 13, 59, 119]),
        ("integration time", with(&plain, "integration_time_us", unknown), vec![7, 119]),
    ];
    for (what, channels, places) in cases {
        let found = of(&channels, "--specular none");
        for at in 0..found.0.len() {
            let (value, invalid) = (found.0[at], found.1[at] & 1 != 0);
            assert_eq!(invalid, places.contains(&at), "{what}, pixel {at}");
            assert!(invalid || value.to_bits() == clean.0[at].to_bits(), "{what}, pixel {at}");
        }
    }
}

#[test]
fn small_and_empty_scenes() {
    for dims in [[1, 5, 6], [1, 1, 1], [4, 1, 1], [4, 3, 3], [2, 1, 7], [2, 7, 1]] {
        for value in [0.0, 1.0, 100.0] {
            let sandbox = Sandbox::new();
            let times = (1..=dims[0]).map(|i| i as f64 * 1000.0).collect();
            let channels = [
                ("amplitude", Array::filled("<u2", &dims, value)),
                ("distance", Array::filled("<f4", &dims, 1.0)),
                ("integration_time_us", Array::new("<f8", &dims[..1], times)),
            ];
            sandbox.recording("rec", &channels);
            every_reader_works(&sandbox);
        }
    }
}

#[test]
fn values_at_the_ends_of_their_types() {
    let extremes = [f64::from(f32::MAX), 1e308, 1e-45, 5e-324, 1.0];
    for name in ["amplitude", "distance", "integration_time_us"] {
        for value in extremes {
            let sandbox = Sandbox::new();
            let dims = get(&sweep(), name).dims.clone();
            sandbox.recording("rec", &with(&sweep(), name, Array::filled("<f8", &dims, value)));
            every_reader_works(&sandbox);
        }
    }
}

#[test]
fn integration_times_per_pixel_frame_and_recording() {
    let constant = |descr: &str, dims: &[usize]| {
        with(&sweep(), "integration_time_us", Array::filled(descr, dims, 2500.0))
    };
    let expected = of(&constant("<f8", &[4]), "");
    expect_same(&of(&constant("<f4", &[4, 5, 6]), ""), &expected, "per pixel");
    let sandbox = Sandbox::new();
    let timeless = without(&sweep(), "integration_time_us");
    sandbox.described("rec", &timeless, "{\"integration_time_us\": 2500}");
    expect_same(&standardize(&sandbox, ""), &expected, "constant in recording.json");
    sandbox.run("info rec").done().prints("2500 µs");

    // Two times in one frame, as some cameras mix them.
    let mixed = (0..120).map(|i| if i % 2 == 0 { 1000.0 } else { 2000.0 }).collect();
    let sandbox = Sandbox::new();
    sandbox.recording("rec", &with(&sweep(), "integration_time_us", Array::new("<u2", &[4, 5, 6], mixed)));
    let found = standardize(&sandbox, "--specular none");
    sandbox.run("info rec").done().prints("1000, 2000 µs, per pixel");
    let short =
        of(&with(&sweep(), "integration_time_us", Array::filled("<f8", &[4], 1000.0)), "--specular none");
    let long =
        of(&with(&sweep(), "integration_time_us", Array::filled("<f8", &[4], 2000.0)), "--specular none");
    for at in 0..120 {
        let expected = if at % 2 == 0 { short.0[at] } else { long.0[at] };
        assert_eq!(found.0[at].to_bits(), expected.to_bits(), "pixel {at}");
    }
}

#[test]
fn amplitude_alone() {
    let sandbox = Sandbox::new();
    sandbox.recording("rec", &without(&without(&sweep(), "distance"), "integration_time_us"));
    every_reader_works(&sandbox);
    sandbox.run("info rec").done().prints("integration time  unknown");
    let (values, _) = standardize(&sandbox, "--specular none");
    // No step is left, so nothing changes.
    assert_eq!(bits(&values), bits(&sandbox.f32s("rec/amplitude.npy")));
}

#[test]
fn saturation_codes() {
    let mut amplitude = get(&sweep(), "amplitude").to("<u2");
    (amplitude.values[3], amplitude.values[4]) = (65535.0, 65534.0);
    let sandbox = Sandbox::new();
    sandbox.described("rec", &with(&sweep(), "amplitude", amplitude), "{\"saturated_amplitude\": 65535}");
    let (values, flags) = standardize(&sandbox, "");
    let saturated = mask(&sandbox, "SATURATED");
    assert!(values[3].is_nan() && !values[4].is_nan());
    let found: Vec<_> = (0..flags.len()).filter(|at| flags[*at] & saturated != 0).collect();
    assert_eq!(found, [3]);
    assert!(sandbox.run("info rec --json").json()["saturated_share"].as_f64().unwrap() > 0.0);
}

#[test]
fn unknown_fields_and_description_go_into_the_output() {
    let sandbox = Sandbox::new();
    let json = r#"{"camera": "X", "lens": {"f_mm": [1, 2.5, null]}, "größe": "測",
        "intrinsics": {"fx": 9, "fy": 9, "cx": 2, "cy": 2, "k1": -0.25}}"#;
    sandbox.described("rec", &sweep(), json);
    standardize(&sandbox, "");
    let (before, after) = (sandbox.json("rec/recording.json"), sandbox.json("out/recording.json"));
    for field in ["camera", "lens", "größe"] {
        assert_eq!(after[field], before[field], "{field}");
    }
    assert_eq!(after["intrinsics"]["k1"], -0.25);
    let steps = after["standardization"]["steps"].as_array().unwrap();
    let terms: Vec<_> = steps.iter().map(|step| step["term"].as_str().unwrap()).collect();
    assert_eq!(terms, ["linear", "square", "histogram"]);
}

#[test]
fn z_distance_becomes_radial() {
    let json = |kind: &str| {
        format!(r#"{{"distance_kind": "{kind}", "intrinsics": {{"fx": 4, "fy": 5, "cx": 2, "cy": 1}}}}"#)
    };
    let [z, radial] = ["z", "radial"].map(|kind| {
        let sandbox = Sandbox::new();
        sandbox.described("rec", &sweep(), &json(kind));
        standardize(&sandbox, "--specular none").0
    });
    for at in 0..30 {
        let (row, column) = ((at / 6) as f64, (at % 6) as f64);
        let ratio_squared = 1.0 + ((column - 2.0) / 4.0).powi(2) + ((row - 1.0) / 5.0).powi(2);
        let expected = f64::from(radial[at]) * ratio_squared;
        // The ratio, the distance and its square are rounded to f32 one after the other: fewer than 8 roundings.
        assert!((f64::from(z[at]) / expected - 1.0).abs() < 8.0 * f64::from(f32::EPSILON), "pixel {at}");
    }
}

#[test]
fn phase_samples_alone() {
    let (amplitude, phase, frequency_hz): (f64, f64, f64) = (100.0, 1.25, 20e6);
    let bin = |k: usize| 500.0 + amplitude * (phase - k as f64 * std::f64::consts::FRAC_PI_2).cos();
    let values = (0..2 * 4 * 6).map(|i| bin(i / 6 % 4)).collect();
    let sandbox = Sandbox::new();
    let json = "{\"modulation_frequency_hz\": 2e7, \"integration_time_us\": 4100}";
    sandbox.described("rec", &[("phase_samples", Array::new("<f4", &[2, 4, 2, 3], values))], json);
    every_reader_works(&sandbox);
    let distance_m = 299_792_458.0 * phase / (4.0 * std::f64::consts::PI * frequency_hz);
    let expected = amplitude * 2.0 * (distance_m / 0.75).powi(2);
    // The bins are rounded to f32 at 600 DN, 6e-8 of that each; relative to 100 DN and 1.25 rad this is below 2e-6.
    for value in standardize(&sandbox, "--specular none").0 {
        assert!((f64::from(value) / expected - 1.0).abs() < 2e-6, "{value} {expected}");
    }
}

#[test]
fn names_and_neighbours_that_are_unusual() {
    let sandbox = Sandbox::new();
    for name in ["größe 测试", "with space", "-dash", "line\nfeed", "a.b.npy"] {
        sandbox.recording(name, &sweep());
        sandbox.write(&format!("{name}/.DS_Store"), "x");
        sandbox.write(&format!("{name}/notes.txt"), "x");
        sandbox.write(&format!("{name}/sub/amplitude.npy"), "x");
        let out = format!("./{name} out");
        sandbox.isolux(&["standardize", "-o", &out, "--", name]).done();
        sandbox.isolux(&["info", "--", &out]).done();
        sandbox.isolux(&["evaluate", "--json", "--", name]).json();
    }
}
