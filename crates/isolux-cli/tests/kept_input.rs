//! `--keep-input`: the input's channels, verbatim, beside the result; and what comes of standardizing that again.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "tests fail by panicking")]

mod common;

use common::{Array, Sandbox, bits, get, npz, standardize, sweep, with};
use zip::CompressionMethod::{Deflated, Stored};

#[test]
fn kept_channels_are_verbatim() {
    let notes = Array::new("<i2", &[4, 2], (0..8).map(f64::from).collect());
    let mut channels = with(&sweep(), "notes", notes);
    channels = with(&channels, "vendor_amplitude", get(&sweep(), "amplitude").to("<u2"));
    channels = with(&channels, "distance", get(&sweep(), "distance").to("<f8"));
    let mut amplitude = get(&sweep(), "amplitude").clone();
    (amplitude.values[0], amplitude.values[1]) = (f64::NAN, -1.0);
    channels = with(&channels, "amplitude", amplitude);
    for method in [None, Some(Stored), Some(Deflated)] {
        let sandbox = Sandbox::new();
        match method {
            None => sandbox.recording("rec", &channels),
            Some(method) => sandbox.write("rec/recording.npz", npz(&channels, method)),
        }
        for threads in ["1", "3"] {
            standardize(&sandbox, &format!("--keep-input --threads {threads}"));
            for (name, array) in &channels {
                let (header, bytes) = sandbox.array(&format!("out/{name}.npy"));
                assert!(header.contains(&array.descr), "{name}: {header}");
                assert!(array.bytes().ends_with(&bytes), "{name}");
                assert_eq!(
                    bytes.len(),
                    array.bytes().len() - common::header(&array.descr, false, &array.dims).len()
                );
            }
        }
    }
}

#[test]
fn other_byte_orders_are_kept_by_value() {
    let amplitude = get(&sweep(), "amplitude").clone();
    let sandbox = Sandbox::new();
    sandbox.recording("rec", &with(&sweep(), "amplitude", amplitude.to(">f4").fortran()));
    standardize(&sandbox, "--keep-input");
    assert_eq!(
        bits(&sandbox.f32s("out/amplitude.npy")),
        bits(&amplitude.values.iter().map(|v| *v as f32).collect::<Vec<_>>())
    );
}

#[test]
fn a_recording_can_be_standardized_again() {
    let sandbox = Sandbox::new();
    sandbox.recording("rec", &sweep());
    let first = standardize(&sandbox, "--keep-input");
    std::fs::rename(sandbox.join("out"), sandbox.join("first")).unwrap();
    sandbox.run("standardize first -o second").done();
    assert_eq!(bits(&sandbox.f32s("second/standardized_amplitude.npy")), bits(&first.0));
    let twice = ["`first`", "`flags`", "--keep-input"];
    sandbox.run("standardize first -o third --keep-input").refused(2, &twice);
    // Without its input there is nothing to start from, and the message says so.
    sandbox.run("standardize second -o third").refused(1, &["`second`", "no `amplitude`"]);
    sandbox.run("info second").done();
}
