//! Recordings of real cameras, where they are there: `../shared/data` beside the repository, or ISOLUX_DATA.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::print_stdout,
    reason = "tests fail by panicking"
)]

mod common;

use std::path::PathBuf;

use common::read;
use isolux::{Channels, IntegrationTime, PixelFlags};
use isolux_io::open;

fn data() -> Option<PathBuf> {
    let beside = || PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/data"));
    let folder = std::env::var_os("ISOLUX_DATA").map_or_else(beside, PathBuf::from);
    if folder.is_dir() {
        return Some(folder);
    }
    println!("skipped: no recordings of real cameras at {}", folder.display());
    None
}

#[test]
fn every_recording_reads_from_the_first_frame_to_the_last() {
    let Some(data) = data() else { return };
    let mut count = 0;
    for entry in std::fs::read_dir(data).unwrap() {
        let folder = entry.unwrap().path();
        if !folder.join("recording.npz").exists() {
            continue;
        }
        let mut recording = open(&folder).unwrap();
        for index in 0..recording.metadata().require_frame_count().unwrap() {
            let frame = read(&mut *recording, index).unwrap();
            frame.check_shapes().unwrap();
            let valid = (0..frame.shape().pixels()).filter(|&pixel| frame.is_valid(pixel)).count();
            // Dark and saturated pixels are there, but no frame is lost to them.
            assert!(valid * 4 > frame.shape().pixels(), "{} frame {index}: {valid}", folder.display());
        }
        count += 1;
    }
    assert!(count >= 6, "{count} recordings");
}

#[test]
fn integration_times_per_pixel_are_those_of_the_camera() {
    let Some(data) = data() else { return };
    let mut recording = open(&data.join("ifm-o3d303")).unwrap();
    let frame = read(&mut *recording, 0).unwrap();
    let IntegrationTime::PerPixel(time) = frame.integration_time_us else { panic!("no map") };
    assert!(time.values().iter().all(|&value| [0.0, 125.0, 5000.0].contains(&value) || value.is_nan()));
}

#[test]
fn saturated_squares_are_flagged_and_depth_is_made_radial() {
    let Some(data) = data() else { return };
    let mut recording = open(&data.join("kinect2-checkerboard")).unwrap();
    let available = recording.metadata().available;
    assert_eq!(available, Channels::AMPLITUDE | Channels::DISTANCE | Channels::TARGET);
    let mut depth_mm = isolux::Plane::filled(recording.metadata().shape, 0.0);
    let mut saturated = 0;
    for index in 0..recording.metadata().require_frame_count().unwrap() {
        let frame = read(&mut *recording, index).unwrap();
        saturated += frame.flags.values().iter().filter(|f| f.contains(PixelFlags::SATURATED)).count();
        recording.read_plane("distance", index, &mut depth_mm).unwrap();
        let distance_m = frame.distance_m.unwrap();
        assert!(distance_m.values().iter().zip(depth_mm.values()).all(|(r, z)| r * 1000.001 >= *z));
    }
    assert!(saturated > 0);
}
