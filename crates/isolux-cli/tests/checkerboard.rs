//! The white squares of a real camera's checkerboard in frames that the calibration has not seen; see
//! `isolux_experiments::unseen::checkerboard`. Skips where the recording is not there.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "tests fail by panicking")]
#![allow(clippy::print_stdout, reason = "the figures are what it is for")]

use std::path::PathBuf;

use isolux::{Channels, Frame};
use isolux_experiments::unseen::checkerboard::{Protocol, spreads};

#[test]
fn white_squares_are_one_material_over_distance_tilt_and_place() {
    let beside = || PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/data"));
    let folder = std::env::var_os("ISOLUX_DATA").map_or_else(beside, PathBuf::from);
    let path = folder.join("kinect2-checkerboard");
    if !path.is_dir() {
        println!("skipped: no recording at {}", path.display());
        return;
    }
    let mut recording = isolux_io::open(&path).unwrap();
    let metadata = recording.metadata().clone();
    let wanted = Channels::AMPLITUDE | Channels::DISTANCE | Channels::TARGET;
    let frames: Vec<Frame> = (0..metadata.frame_count.unwrap())
        .map(|index| {
            let mut frame = Frame::new(metadata.shape);
            recording.read_frame(index, wanted, &mut frame).unwrap();
            frame
        })
        .collect();
    let intrinsics = metadata.info.intrinsics.unwrap().pinhole;
    let spreads = spreads(&frames, &Protocol { intrinsics, label: 1, nearest_m: 0.68 }).unwrap();
    println!("spread of ln A over the white squares, frames not fitted on:");
    for spread in &spreads {
        let (name, sd, robust) = (spread.name, spread.deviation, spread.robust);
        println!(
            "{name:>24}: sd {sd:.3}, 1.4826 MAD {robust:.3}, {} of {} windows",
            spread.windows, spread.of
        );
    }
    let all = spreads.last().unwrap();
    // The aim: half of what a cubic over distance leaves, without leaving windows out.
    assert!(all.deviation <= 0.085 && all.robust <= 0.055, "{all:?}");
    assert!(all.windows as f64 > 0.99 * all.of as f64 && all.of > 700, "{all:?}");
}
