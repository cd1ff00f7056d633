//! What is written reads back bit by bit, and does not depend on the number of threads.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "tests fail by panicking")]

mod common;
#[path = "../../isolux/tests/common/strategies.rs"]
#[allow(dead_code, unreachable_pub, reason = "other tests use the rest of it")]
mod strategies;

use std::path::Path;

use common::run;
use isolux::calibration::{NoiseFloor, Terms};
use isolux::{Calibration, Frame, IntegrationTime, Reference};
use isolux_io::{ChannelSpec, ElementType, RecordingInfo, RecordingWriter};
use proptest::prelude::*;
use strategies::{
    CHANNELS, PIXELS, SHAPE, bits, calibration, cases, cubics, frames, luts, noises, responses, splines,
    words,
};

proptest! {
    #![proptest_config(cases(64))]

    /// Every number of a calibration is read as the same f64 that was written.
    #[test]
    fn a_calibration_file_reads_back(
        camera in prop::option::of(".{0,20}"), lut in prop::option::of(luts()), cubic in prop::option::of(cubics()),
        response in prop::option::of(responses()), spline in prop::option::of(splines()),
        noise in prop::option::of(noises()),
        time in 1.0..1e5f64, distance_m in 0.01..100.0f64, floor in prop::option::of((0.01..99.0f64, 1.0..1e4f64)),
        warnings in words(),
    ) {
        let reference = Reference { integration_time_us: Some(time), distance_m };
        let mut written = Calibration::new(camera, reference);
        written.terms = Terms { lut, response, cubic, spline, noise, ..Terms::default() };
        if let Some(spline) = & written.terms.spline {
            written.reference.distance_m = spline.law.reference_distance_m;
        }
        written.noise_floor = floor.map(|(sd, time)| NoiseFloor::new(sd, time));
        written.warnings = warnings;
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("CAMERA.json");
        isolux_io::write_calibration(&written, &path).unwrap();
        prop_assert_eq!(isolux_io::read_calibration(&path).unwrap(), written);
    }

    /// A recording's frames come back bit by bit, from a folder and from an archive.
    #[test]
    fn a_recording_reads_back(written in prop::collection::vec(frames(), 1..5), packed in any::<bool>()) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(if packed { "recording.npz" } else { "recording" });
        record(&written, &path);
        let mut recording = isolux_io::open(&path).unwrap();
        prop_assert_eq!((recording.metadata().frame_count, recording.metadata().shape), (Some(written.len()), SHAPE));
        let mut frame = Frame::new(SHAPE);
        for (index, written) in written.iter().enumerate().rev() {
            recording.read_frame(index, CHANNELS, &mut frame).unwrap();
            prop_assert_eq!(bits(&frame.amplitude), bits(&written.amplitude));
            let distances = |frame: &Frame| bits(frame.distance_m.as_ref().unwrap());
            prop_assert_eq!(distances(&frame), distances(written));
            let IntegrationTime::PerPixel(times) = &frame.integration_time_us else { panic!("no map") };
            let expected = times_of(written);
            prop_assert_eq!(times.values().iter().map(|t| t.to_bits()).collect::<Vec<_>>(),
                expected.iter().map(|t| t.to_bits()).collect::<Vec<_>>());
        }
    }
}

/// The integration time of each pixel.
fn times_of(frame: &Frame) -> Vec<f32> {
    match &frame.integration_time_us {
        IntegrationTime::Unknown => vec![f32::NAN; PIXELS],
        IntegrationTime::PerFrame(time) => vec![*time as f32; PIXELS],
        IntegrationTime::PerPixel(map) => map.values().to_vec(),
    }
}

fn record(frames: &[Frame], path: &Path) {
    let image = |name| ChannelSpec::image(name, ElementType::F32, SHAPE);
    let channels = ["amplitude", "distance", "integration_time_us"].map(image).to_vec();
    let mut writer = RecordingWriter::create(path, frames.len(), channels, false).unwrap();
    for frame in frames {
        writer.push("amplitude", frame.amplitude.values()).unwrap();
        writer.push("distance", frame.distance_m.as_ref().unwrap().values()).unwrap();
        writer.push("integration_time_us", &times_of(frame)).unwrap();
    }
    writer.finish(&RecordingInfo::default()).unwrap();
}

/// Name and bytes of every file in a folder.
fn files(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let entries = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let name = |path: &Path| path.file_name().unwrap().to_string_lossy().into_owned();
    let mut files: Vec<_> = entries.map(|path| (name(&path), std::fs::read(&path).unwrap())).collect();
    files.sort();
    files
}

/// Seven frames make a rest with every number of threads but one.
#[test]
fn any_number_of_threads_writes_the_same_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let scene = include_str!("../../isolux-camera/scenes/highlights.toml")
        .replace(
            "integration_times_us = [2000.0, 4200.0, 8200.0]",
            "integration_times_us = [150.0, 2000.0, 4200.0, 8200.0, 12000.0, 16000.0, 19000.0]",
        )
        .replace("frames_per_time = 3", "frames_per_time = 1");
    std::fs::write(path("scene.toml"), scene).unwrap();
    isolux_io::write_calibration(&calibration(), &path("CAMERA.json")).unwrap();
    run(&[&"simulate", &path("scene.toml"), &"-o", &path("scene")]);
    let outputs = ["1", "2", "5"].map(|threads| {
        let (scene, output, camera) = (path("scene"), path(threads), path("CAMERA.json"));
        let args: [&dyn AsRef<std::ffi::OsStr>; 9] =
            [&"standardize", &scene, &"-o", &output, &"-c", &camera, &"--keep-input", &"--threads", &threads];
        run(&args);
        files(&output)
    });
    let names: Vec<&str> = outputs[0].iter().map(|(name, _)| name.as_str()).collect();
    assert!(names.contains(&"standardized_amplitude.npy") && names.contains(&"flags.npy"), "{names:?}");
    assert!(outputs[0] == outputs[1] && outputs[0] == outputs[2], "{names:?}");
    // The input's channels are kept verbatim.
    for (name, bytes) in files(&path("scene")).into_iter().filter(|(name, _)| name.ends_with(".npy")) {
        assert!(outputs[0].contains(&(name.clone(), bytes)), "{name}");
    }
}
