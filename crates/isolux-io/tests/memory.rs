//! Memory stays flat however long the recording is.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "tests fail by panicking")]
#![cfg(target_os = "linux")]

mod common;

use std::fs;

use common::{Folder, header};
use isolux::{Channels, Frame};

/// Peak resident memory of this process, bytes.
fn peak_bytes() -> usize {
    let status = fs::read_to_string("/proc/self/status").unwrap();
    let line = status.lines().find(|line| line.starts_with("VmHWM:")).unwrap();
    line.split_whitespace().nth(1).unwrap().parse::<usize>().unwrap() * 1024
}

/// An array of zeros that takes no room on disk.
fn sparse(folder: &Folder, name: &str, fortran: bool, frames: usize) -> usize {
    let path = folder.join(name);
    let bytes = header("<u2", fortran, &[frames, 512, 512]);
    fs::write(&path, &bytes).unwrap();
    let length = frames * 512 * 512 * 2;
    let file = fs::OpenOptions::new().write(true).open(&path).unwrap();
    file.set_len((bytes.len() + length) as u64).unwrap();
    length
}

fn read_all(folder: &Folder) {
    let mut recording = folder.open().unwrap();
    let mut frame = Frame::new(recording.metadata().shape);
    for index in 0..recording.metadata().require_frame_count().unwrap() {
        recording.read_frame(index, Channels::all(), &mut frame).unwrap();
    }
}

// One test, since the peak is the process's.
#[test]
fn a_recording_is_never_in_memory_as_a_whole() {
    let before = peak_bytes();
    let folder = Folder::new();
    let length = sparse(&folder, "amplitude.npy", false, 1024) + sparse(&folder, "distance.npy", false, 1024);
    read_all(&folder);
    // One window of 8 MiB for each channel, and a few planes of 1 MiB.
    let grown = peak_bytes() - before;
    assert!(grown < 64 << 20, "{grown} bytes for a recording of {length}");

    let folder = Folder::new();
    let length = sparse(&folder, "amplitude.npy", true, 384) + sparse(&folder, "distance.npy", true, 384);
    read_all(&folder);
    // Batches of 48 MiB for each of the two channels.
    let grown = peak_bytes() - before;
    assert!(grown < 160 << 20, "{grown} bytes for a recording of {length} in Fortran order");
}
