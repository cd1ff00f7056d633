//! Bad folders: one clear message each, with file, found and expected; never a panic.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "tests fail by panicking")]

mod common;

use std::fs;

use common::{Array, Folder, failure, header};

fn amplitude() -> (&'static str, Array) {
    ("amplitude", Array::counting("<u2", &[2, 3, 4]))
}

/// Fails unless the message holds every part.
fn expect(message: &str, parts: &[&str]) {
    for part in parts {
        assert!(message.contains(part), "no \"{part}\" in: {message}");
    }
}

/// The message for a folder whose amplitude file holds these bytes.
fn with_amplitude_bytes(bytes: &[u8]) -> String {
    let folder = Folder::new();
    folder.write("amplitude.npy", bytes);
    failure(folder.path())
}

#[test]
fn paths_that_lead_to_no_recording() {
    let folder = Folder::new();
    expect(&failure(&folder.join("absent")), &["cannot open", "absent", "No such file"]);
    expect(&failure(folder.path()), &["a folder with nothing", "expected a recording"]);
    folder.write("notes.txt", b"");
    expect(&failure(folder.path()), &["a folder with `notes.txt`"]);
    expect(&failure(&folder.join("notes.txt")), &["a file without .npz at the end"]);
    folder.write("amplitude.npy", &amplitude().1.bytes());
    expect(&failure(&folder.join("amplitude.npy")), &["one file of a recording; give its folder"]);
    folder.write("recording.npz", b"");
    expect(&failure(folder.path()), &["both .npy files and recording.npz"]);
}

#[test]
fn damaged_headers() {
    expect(&with_amplitude_bytes(b""), &["amplitude.npy", "found an empty file, expected a .npy array"]);
    expect(&with_amplitude_bytes(b"PK\x03\x04 and so on"), &["other bytes than NumPy's signature"]);
    expect(&with_amplitude_bytes(b"\x93NUMPY\x09\x00\x00\x00"), &["found npy version 9.0"]);
    expect(&with_amplitude_bytes(b"\x93NUMPY\x02\x00\xff\xff\xff\xffx"), &["a header of 4294967295 bytes"]);
    expect(&with_amplitude_bytes(b"\x93NUMPY\x01\x00\xff\xff{'descr"), &["ends inside its header"]);
}

#[test]
fn claims_that_the_file_does_not_hold() {
    let huge = header("<f8", false, &[1 << 40, 1 << 20, 1 << 10]);
    expect(
        &with_amplitude_bytes(&huge),
        &["amplitude.npy", "expected more than can be counted, from its header"],
    );
    let large = header("<f8", false, &[1000, 1000, 1000]);
    let expected =
        format!("expected {}, from its header: (1000, 1000, 1000) of float64", 8_000_000_000 + large.len());
    expect(&with_amplitude_bytes(&large), &[&expected]);
    let whole = amplitude().1.bytes();
    let lengths = [whole.len() - 1, whole.len() + 1];
    for length in lengths {
        let mut bytes = whole.clone();
        bytes.resize(length, 0);
        let (found, expected) = (format!("found {length} bytes"), format!("expected {}", whole.len()));
        expect(&with_amplitude_bytes(&bytes), &["amplitude.npy", &found, &expected]);
    }
}

#[test]
fn arrays_that_are_no_real_numbers() {
    for (descr, kind) in
        [("|O", "Python objects"), ("<c32", "complex"), ("<U5", "strings"), ("<M8[us]", "dates")]
    {
        let bytes = header(descr, false, &[2, 3, 4]);
        expect(&with_amplitude_bytes(&bytes), &["amplitude.npy", kind, descr, ".astype(...)"]);
    }
}

#[test]
fn shapes_that_do_not_fit() {
    let single = Folder::with(&[("amplitude", Array::counting("<u2", &[3, 4]))]);
    expect(&failure(single.path()), &["found an array of shape (3, 4), expected (N, H, W)", "numpy.newaxis"]);
    let empty = Folder::with(&[("amplitude", Array::counting("<u2", &[0, 3, 4]))]);
    expect(&failure(empty.path()), &["(0, 3, 4)", "at least one frame and one pixel"]);
    let fewer = Folder::with(&[amplitude(), ("distance", Array::counting("<u2", &[1, 3, 4]))]);
    expect(
        &failure(fewer.path()),
        &["distance.npy", "found an array of shape (1, 3, 4), expected (2, 3, 4)"],
    );
    let foreign = Folder::with(&[amplitude(), ("weights", Array::counting("<u2", &[3]))]);
    expect(&failure(foreign.path()), &["weights.npy", "(3,)", "expected 2 as its first dimension"]);
    let labels = Folder::with(&[amplitude(), ("target", Array::counting("<f4", &[2, 3, 4]))]);
    expect(&failure(labels.path()), &["target.npy", "found labels of type float32, expected uint8"]);
    let alone = Folder::with(&[("distance", Array::counting("<u2", &[2, 3, 4]))]);
    expect(&failure(alone.path()), &["no `amplitude` and no `phase_samples`, only `distance`"]);
}

#[test]
fn frames_beyond_any_camera_are_refused_before_memory_is_asked_for() {
    // Zeros that deflate to little: the sizes are honest, the frame is not.
    let folder = Folder::new();
    let pixels = 1usize << 27;
    let mut bytes = header("|u1", false, &[1, pixels, 1]);
    bytes.resize(bytes.len() + pixels, 0);
    common::archive(&folder.join("big.npz"), &[("amplitude.npy", bytes)], zip::CompressionMethod::Deflated);
    expect(
        &failure(&folder.join("big.npz")),
        &["big.npz/amplitude.npy", "at most 67108864 values in a frame"],
    );
}

#[test]
fn integration_times_without_meaning() {
    let per_frame = |values: [f64; 2]| {
        let folder = Folder::with(&[amplitude(), ("integration_time_us", Array::of("<f8", &[2], &values))]);
        failure(folder.path())
    };
    expect(
        &per_frame([8.0, -5.0]),
        &["integration_time_us.npy`, frame 1: found -5, expected a positive number"],
    );
    expect(&per_frame([0.0, 8.0]), &["frame 0: found 0, expected a positive number"]);
    expect(&per_frame([f64::INFINITY, 8.0]), &["frame 0: found inf"]);
    let mut map = Array::counting("<f4", &[2, 3, 4]);
    map.values[12 + 6] = -1.0;
    let folder = Folder::with(&[amplitude(), ("integration_time_us", map)]);
    expect(
        &failure(folder.path()),
        &["frame 1, row 1, column 2: found -1, expected", "NaN or 0 where it is unknown"],
    );
}

#[test]
fn labels_beyond_a_byte() {
    let mut target = Array::counting("<i2", &[2, 3, 4]);
    target.values[1] = 256.0;
    let folder = Folder::with(&[amplitude(), ("target", target)]);
    expect(&failure(folder.path()), &["target.npy`, frame 0, row 0, column 1: found 256, expected a label"]);
}

#[test]
fn foreign_and_impossible_json() {
    let arrays = [amplitude(), ("distance", Array::counting("<u2", &[2, 3, 4]))];
    let message = |json: &str| failure(Folder::described(&arrays, json).path());
    expect(&message("[1]"), &["recording.json", "found an array, expected a JSON object"]);
    expect(&message("\"text\""), &["found a string"]);
    expect(&message("{\"camera\": "), &["recording.json", "not valid JSON"]);
    expect(
        &message(r#"{"distance_unit": "cm"}"#),
        &["field `distance_unit`: found \"cm\", expected \"m\", \"mm\", or the metres of one unit"],
    );
    expect(&message(r#"{"integration_time_us": -1}"#), &["field `integration_time_us`", "positive"]);
    expect(&message(r#"{"distance_kind": "z"}"#), &["field `intrinsics`: found nothing"]);
    let bad = r#"{"distance_kind": "z", "intrinsics": {"fx": -1, "fy": 1, "cx": 0, "cy": 0}}"#;
    expect(&message(bad), &["field `intrinsics`", "fx and fy positive"]);
    let folder = Folder::with(&arrays);
    folder.write("recording.json", b"\xff\xfe{}");
    expect(&failure(folder.path()), &["recording.json", "not valid JSON"]);
}

#[test]
fn folders_in_the_place_of_files() {
    let folder = Folder::new();
    fs::create_dir(folder.join("amplitude.npy")).unwrap();
    expect(&failure(folder.path()), &["amplitude.npy", "found a folder, expected a .npy file"]);
    let folder = Folder::with(&[amplitude()]);
    fs::create_dir(folder.join("recording.json")).unwrap();
    expect(&failure(folder.path()), &["recording.json", "found a folder or device"]);
    let folder = Folder::new();
    fs::create_dir(folder.join("recording.npz")).unwrap();
    expect(&failure(folder.path()), &["recording.npz", "found a folder or device"]);
}

#[cfg(unix)]
mod unix {
    use std::ffi::OsStr;
    use std::os::unix::ffi::OsStrExt;
    use std::os::unix::fs::symlink;

    use super::*;

    #[test]
    fn links_are_followed_and_broken_ones_named() {
        let elsewhere = Folder::with(&[amplitude()]);
        let folder = Folder::new();
        symlink(elsewhere.join("amplitude.npy"), folder.join("amplitude.npy")).unwrap();
        assert!(folder.open().is_ok());
        symlink("nowhere", folder.join("recording.json")).unwrap();
        expect(&failure(folder.path()), &["recording.json", "No such file"]);
        fs::remove_file(folder.join("recording.json")).unwrap();
        symlink("distance.npy", folder.join("distance.npy")).unwrap();
        expect(&failure(folder.path()), &["cannot open", "distance.npy"]);
    }

    #[test]
    fn sockets_and_devices_are_not_waited_for() {
        let folder = Folder::new();
        let _socket = std::os::unix::net::UnixListener::bind(folder.join("amplitude.npy")).unwrap();
        expect(&failure(folder.path()), &["amplitude.npy", "a device or pipe"]);
        expect(&failure("/dev/null".as_ref()), &["neither a file nor a folder"]);
    }

    #[test]
    fn names_that_are_not_utf8() {
        let folder = Folder::new();
        let inner = folder.path().join(OsStr::from_bytes(b"r\xe9c \n"));
        fs::create_dir(&inner).unwrap();
        fs::write(inner.join("amplitude.npy"), amplitude().1.bytes()).unwrap();
        assert!(isolux_io::open(&inner).is_ok());
        fs::write(inner.join(OsStr::from_bytes(b"\xff.npy")), b"").unwrap();
        expect(&failure(&inner), &["a file name that is not UTF-8"]);
    }
}

#[test]
fn a_file_that_shrinks_while_it_is_read_is_noticed() {
    // Two frames of more than one mapped window each.
    let folder = Folder::new();
    let mut bytes = header("|u1", false, &[2, 3000, 3000]);
    let start = bytes.len();
    bytes.resize(start + 2 * 9_000_000, 7);
    folder.write("amplitude.npy", &bytes);
    let mut recording = folder.open().unwrap();
    common::read(&mut *recording, 0).unwrap();
    fs::OpenOptions::new()
        .write(true)
        .open(folder.join("amplitude.npy"))
        .unwrap()
        .set_len(9_000_100)
        .unwrap();
    let message = common::read(&mut *recording, 1).unwrap_err().to_string();
    expect(&message, &["found 9000100 bytes, fewer than when it was opened"]);
}
