//! Memory stays flat, whatever the length of a recording.
#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "tests fail by panicking")]

mod common;

use std::fs::File;

use common::{Sandbox, header};

/// The contract's limit. Two threads hold two frames, so "a few frames" add nothing to speak of.
const LIMIT_BYTES: u64 = 300 << 20;

/// A channel of zeros that takes no room on the disk.
fn sparse(sandbox: &Sandbox, path: &str, descr: &str, fortran: bool, dims: &[usize]) -> u64 {
    let header = header(descr, fortran, dims);
    sandbox.write(path, &header);
    let element: u64 = descr[2..].parse().unwrap();
    let bytes = header.len() as u64 + dims.iter().product::<usize>() as u64 * element;
    File::options().write(true).open(sandbox.join(path)).unwrap().set_len(bytes).unwrap();
    bytes
}

/// Peak memory of standardizing and evaluating a recording of these frames.
fn expect_flat(fortran: bool, dims: [usize; 3], threads: &str) {
    let sandbox = Sandbox::new();
    let sizes = ["amplitude", "distance"]
        .map(|channel| sparse(&sandbox, &format!("rec/{channel}.npy"), "<f8", fortran, &dims));
    let size: u64 = sizes.iter().sum();
    assert!(size > LIMIT_BYTES + (64 << 20), "{size} bytes would prove nothing");
    let command = ["standardize", "rec", "-o", "out", "--threads", threads];
    let (code, peak) = common::peak_memory(&mut sandbox.command(&command));
    assert_eq!(code, 0);
    assert!(peak < LIMIT_BYTES, "{peak} bytes for a recording of {size}, {threads} threads");
}

#[test]
fn a_long_recording() {
    expect_flat(false, [84, 480, 640], "2");
}

#[test]
fn a_long_recording_in_fortran_order() {
    expect_flat(true, [84, 480, 640], "2");
}

/// As many threads as a large machine has; each would like frames of its own.
#[test]
fn many_threads() {
    expect_flat(false, [28, 1000, 1000], "64");
}
