//! Bad input: exit code 1 or 2, one clear message, nothing on stdout, nothing left behind, never a panic.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "tests fail by panicking")]

mod common;

use common::{Array, Channels, READERS, Sandbox, archive, header, refused_by, sweep, with, without};
use zip::CompressionMethod::{Deflated, Stored};

/// A folder recording that no command can read.
fn unreadable(channels: &[(&str, Array)], json: Option<&str>, parts: &[&str]) {
    let sandbox = Sandbox::new();
    sandbox.recording("bad", channels);
    if let Some(json) = json {
        sandbox.write("bad/recording.json", json);
    }
    refused_by(&READERS, &sandbox, "bad", parts);
}

/// A folder recording whose `amplitude.npy` holds these bytes.
fn unreadable_amplitude(bytes: &[u8], parts: &[&str]) {
    let sandbox = Sandbox::new();
    sandbox.recording("bad", &without(&sweep(), "amplitude"));
    sandbox.write("bad/amplitude.npy", bytes);
    refused_by(&READERS, &sandbox, "bad", &[&["bad/amplitude.npy"], parts].concat());
}

fn amplitude() -> Array {
    sweep().swap_remove(0).1
}

#[test]
fn paths_that_lead_to_no_recording() {
    let sandbox = Sandbox::new();
    sandbox.write("notes.txt", "x");
    sandbox.write("camera-of-old.json", "{}");
    sandbox.write("empty.npz", "");
    sandbox.write("text.npz", "no archive");
    sandbox.write("folder.npz/notes.txt", "x");
    sandbox.write("folder/notes.txt", "x");
    sandbox.recording("good", &sweep());
    let cases: [(&str, &[&str]); 9] = [
        ("absent", &["cannot open `absent`", "No such file"]),
        ("absent.npz", &["cannot open `absent.npz`", "No such file"]),
        ("notes.txt", &["`notes.txt`", "expected a recording"]),
        ("camera-of-old.json", &["`camera-of-old.json`", "expected a recording"]),
        ("good/amplitude.npy", &["one file of a recording; give its folder"]),
        ("empty.npz", &["`empty.npz`: found an empty file"]),
        ("text.npz", &["`text.npz`: found damaged data"]),
        ("folder.npz", &["`folder.npz`: found a folder with `notes.txt`"]),
        ("folder", &["`folder`: found a folder with `notes.txt`", "expected a recording"]),
    ];
    for (path, parts) in cases {
        refused_by(&READERS, &sandbox, path, parts);
    }
}

#[test]
fn damaged_arrays() {
    let whole = amplitude().bytes();
    unreadable_amplitude(b"", &["found an empty file"]);
    unreadable_amplitude(&whole[..7], &["ends inside its header"]);
    unreadable_amplitude(&whole[..whole.len() - 1], &["found", "bytes, expected", "(4, 5, 6) of float32"]);
    unreadable_amplitude(&[&whole[..], b"x"].concat(), &["bytes, expected", "(4, 5, 6) of float32"]);
    unreadable_amplitude(b"PK\x03\x04", &["other bytes than NumPy's signature"]);
    unreadable_amplitude(&header("|O", false, &[4, 5, 6]), &["Python objects", ".astype(...)"]);
    unreadable_amplitude(&header("<c32", false, &[4, 5, 6]), &["complex"]);
    unreadable_amplitude(&header("<f4", false, &[0, 5, 6]), &["(0, 5, 6)", "at least one frame"]);
    unreadable_amplitude(&Array::filled("<f4", &[5, 6], 1.0).bytes(), &["(5, 6)", "numpy.newaxis"]);
}

#[test]
fn channels_that_do_not_fit_together() {
    let bad = |name, array| with(&sweep(), name, array);
    let ones = |dims: &[usize]| Array::filled("<f4", dims, 1.0);
    let cases: [(Channels, &[&str]); 6] = [
        (without(&sweep(), "amplitude"), &["`bad`", "no `amplitude` and no `phase_samples`", "`distance`"]),
        (bad("distance", ones(&[4, 6, 5])), &["distance.npy", "(4, 6, 5), expected (4, 5, 6)"]),
        (
            bad("integration_time_us", ones(&[3])),
            &["integration_time_us.npy", "(3,), expected (4,) or (4, 5, 6)"],
        ),
        (
            bad("phase_samples", ones(&[4, 3, 5, 6])),
            &["phase_samples.npy", "(4, 3, 5, 6), expected (4, 4, 5, 6)"],
        ),
        (bad("target", ones(&[4, 5, 6])), &["target.npy", "float32, expected uint8"]),
        (bad("notes", ones(&[7])), &["notes.npy", "(7,), expected 4 as its first dimension"]),
    ];
    for (channels, parts) in cases {
        unreadable(&channels, None, parts);
    }
}

#[test]
fn descriptions_that_cannot_be_used() {
    let deep = format!("{{\"x\": {}1{}}}", "[".repeat(100_000), "]".repeat(100_000));
    let cases: [(&str, &[&str]); 9] = [
        ("", &["not valid JSON"]),
        ("[1, 2]", &["found an array, expected a JSON object"]),
        ("{\"camera\": ", &["not valid JSON", "line 1"]),
        (&deep, &["not valid JSON", "recursion limit"]),
        ("{\"integration_time_us\": 5}", &["field `integration_time_us`", "remove one"]),
        ("{\"distance_kind\": \"z\"}", &["field `intrinsics`", "found nothing"]),
        (
            "{\"distance_unit\": \"cm\"}",
            &["field `distance_unit`: found \"cm\", expected \"m\", \"mm\", or the metres of one unit"],
        ),
        ("{\"saturated_amplitude\": -1}", &["field `saturated_amplitude`", "a positive number"]),
        ("{\"modulation_frequency_hz\": 1e999}", &["not valid JSON", "out of range"]),
    ];
    for (json, parts) in cases {
        unreadable(&sweep(), Some(json), &[&["bad/recording.json"], parts].concat());
    }
}

#[test]
fn integration_times_without_meaning() {
    let times =
        |values: [f64; 4]| with(&sweep(), "integration_time_us", Array::new("<f8", &[4], values.to_vec()));
    let file = "bad/integration_time_us.npy";
    unreadable(&times([1e3, -5.0, 2e3, 3e3]), None, &[file, "frame 1: found -5, expected a positive number"]);
    unreadable(&times([1e3, 2e3, 3e3, 0.0]), None, &[file, "frame 3: found 0, expected a positive number"]);
    unreadable(&times([f64::INFINITY, 1e3, 2e3, 3e3]), None, &[file, "frame 0: found inf"]);
    let mut map = Array::filled("<f4", &[4, 5, 6], 1000.0);
    map.values[30 + 6 + 2] = -1.0;
    let map = with(&sweep(), "integration_time_us", map);
    let sandbox = Sandbox::new();
    sandbox.recording("bad", &map);
    refused_by(&READERS[..6], &sandbox, "bad", &[file, "frame 1, row 1, column 2: found -1"]);
}

#[test]
fn unknown_times_are_refused_by_what_needs_them() {
    let times = Array::new("<f8", &[4], vec![1000.0, f64::NAN, 2000.0, 3000.0]);
    let sandbox = Sandbox::new();
    sandbox.recording("bad", &with(&sweep(), "integration_time_us", times));
    let needing = ["standardize BAD -o out", "evaluate BAD", READERS[6]];
    refused_by(&needing, &sandbox, "bad", &["`bad`", "frame 1", "integration time", "unknown"]);
    sandbox.run("info bad").done();
    sandbox.run("standardize bad -o out --time none").done();
}

#[test]
fn labels_beyond_a_byte() {
    let mut target = Array::filled("<i2", &[4, 5, 6], 1.0);
    target.values[7] = 256.0;
    let sandbox = Sandbox::new();
    sandbox.recording("bad", &with(&sweep(), "target", target));
    let parts = ["bad/target.npy", "frame 0, row 1, column 1: found 256, expected a label of 0 to 255"];
    refused_by(&["evaluate BAD"], &sandbox, "bad", &parts);
}

/// What a header claims costs no memory: with little address space the message is the same.
#[cfg(target_os = "linux")]
#[test]
fn huge_headers_allocate_nothing() {
    let headers = [
        header("<f8", false, &[1 << 40, 1 << 10, 1 << 10]),
        header("<f8", true, &[1 << 12, 1 << 12, 1 << 12]),
        header("|u1", false, &[1, 1 << 16, 1 << 18]),
        b"\x93NUMPY\x02\x00\xff\xff\xff\xff{".to_vec(),
        b"\x93NUMPY\x03\x00\xff\xff\xff\x7f{'descr".to_vec(),
    ];
    for header in headers {
        let sandbox = Sandbox::new();
        sandbox.write("bad/amplitude.npy", &header);
        sandbox.write("stored.npz", archive(&[("amplitude.npy", header.clone())], Stored));
        sandbox.write("deflated.npz", archive(&[("amplitude.npy", header)], Deflated));
        for bad in ["bad", "stored.npz", "deflated.npz"] {
            let mut command = sandbox.command(&["standardize", bad, "-o", "out"]);
            common::limit_address_space(&mut command, 128 << 20);
            common::Run::new(command).refused(1, &["amplitude.npy", "found", "expected"]);
        }
    }
}

/// Zeros that deflate to little: the sizes are honest, a frame of 4 GiB is not.
#[cfg(target_os = "linux")]
#[test]
fn frames_beyond_any_camera_allocate_nothing() {
    let sandbox = Sandbox::new();
    sandbox.write("bad/amplitude.npy", header("|u1", false, &[1, 1 << 16, 1 << 16]));
    let file = std::fs::OpenOptions::new().write(true).open(sandbox.join("bad/amplitude.npy")).unwrap();
    let data = file.metadata().unwrap().len();
    file.set_len(data + (1 << 32)).unwrap();
    for command in ["info bad", "standardize bad -o out", "evaluate bad"] {
        let mut command = sandbox.command(&command.split(' ').collect::<Vec<_>>());
        common::limit_address_space(&mut command, 128 << 20);
        common::Run::new(command).refused(1, &["bad/amplitude.npy", "(65536, 65536)", "values in a frame"]);
    }
}

#[cfg(unix)]
#[test]
fn pipes_devices_and_loops_are_not_waited_for() {
    let sandbox = Sandbox::new();
    let make_pipe = |name: &str| {
        let path = std::ffi::CString::new(sandbox.join(name).to_str().unwrap()).unwrap();
        // SAFETY: the path is a C string that lives through the call.
        assert_eq!(unsafe { libc::mkfifo(path.as_ptr(), 0o600) }, 0);
    };
    let link = |to: &str, name: &str| std::os::unix::fs::symlink(to, sandbox.join(name)).unwrap();
    make_pipe("pipe.npz");
    for name in ["piped", "described", "looped", "zero"] {
        sandbox.recording(name, &without(&sweep(), "amplitude"));
    }
    make_pipe("piped/amplitude.npy");
    sandbox.recording("described", &sweep());
    make_pipe("described/recording.json");
    link("amplitude.npy", "looped/amplitude.npy");
    link("/dev/zero", "zero/amplitude.npy");
    link("itself", "itself");
    let cases: [(&str, &[&str]); 6] = [
        ("pipe.npz", &["`pipe.npz`: found neither a file nor a folder"]),
        ("piped", &["piped/amplitude.npy", "a device or pipe"]),
        ("described", &["described/recording.json", "device"]),
        ("looped", &["looped/amplitude.npy"]),
        ("zero", &["zero/amplitude.npy", "a device or pipe"]),
        ("itself", &["cannot open `itself`"]),
    ];
    for (path, parts) in cases {
        refused_by(&READERS, &sandbox, path, parts);
    }
}
