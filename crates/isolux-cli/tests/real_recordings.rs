//! Recordings of real cameras through the program, where they are there: `../shared/data` beside the repository,
//! or ISOLUX_DATA.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "tests fail by panicking")]
#![allow(clippy::print_stdout, reason = "a test that skips says so")]

mod common;

use std::path::{Path, PathBuf};

use common::run;
use isolux::{Channels, Frame, IntegrationTime, PixelFlags, Plane};
use isolux_io::Recording;

fn data() -> Option<PathBuf> {
    let beside = || PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/data"));
    let folder = std::env::var_os("ISOLUX_DATA").map_or_else(beside, PathBuf::from);
    if folder.is_dir() {
        return Some(folder);
    }
    println!("skipped: no recordings of real cameras at {}", folder.display());
    None
}

fn image(recording: &mut dyn Recording, channel: &str, index: usize) -> Vec<f32> {
    let mut plane = Plane::filled(recording.metadata().shape, 0.0);
    recording.read_plane(channel, index, &mut plane).unwrap();
    plane.values().to_vec()
}

fn is_invalid(flags: f32) -> bool {
    PixelFlags::from_bits_retain(flags as u16).contains(PixelFlags::INVALID)
}

/// Of one frame, whether each value is NaN exactly where INVALID is flagged.
fn assert_nan_is_invalid(output: &Path) -> usize {
    let mut recording = isolux_io::open(output).unwrap();
    let mut valid = 0;
    for index in 0..recording.metadata().frame_count.unwrap() {
        let values = image(&mut *recording, "standardized_amplitude", index);
        let flags = image(&mut *recording, "flags", index);
        for (pixel, (value, flags)) in values.into_iter().zip(flags).enumerate() {
            let place = || format!("{} frame {index} pixel {pixel}: {value} {flags}", output.display());
            assert_eq!(value.is_nan(), is_invalid(flags), "{}", place());
            assert!(value.is_nan() || (value > 0.0 && value.is_finite()), "{}", place());
            valid += usize::from(!value.is_nan());
        }
    }
    valid
}

#[test]
fn every_recording_goes_through_info_and_standardize() {
    let Some(data) = data() else { return };
    let folder = tempfile::tempdir().unwrap();
    let mut count = 0;
    for entry in std::fs::read_dir(data).unwrap() {
        let recording = entry.unwrap().path();
        if !recording.join("recording.json").exists() {
            continue;
        }
        let info = run(&[&"info", &recording, &"--json"]);
        let info: serde_json::Value = serde_json::from_str(&info).unwrap();
        assert!(info["frames"].as_u64().unwrap() > 0, "{info}");
        let output = folder.path().join(recording.file_name().unwrap());
        run(&[&"standardize", &recording, &"-o", &output]);
        let pixels = info["frames"].as_u64().unwrap() * info["height"].as_u64().unwrap();
        // Dark, saturated and range-less pixels are there, but no recording is lost to them.
        let valid = assert_nan_is_invalid(&output) as u64;
        assert!(valid * 4 > pixels * info["width"].as_u64().unwrap(), "{}: {valid}", recording.display());
        count += 1;
    }
    assert!(count >= 6, "{count} recordings");
}

/// Standard deviation.
fn spread(values: &[f64]) -> f64 {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / count).sqrt()
}

/// The camera mixes two exposures within a frame, and its maker normalizes them. Textbook physics, t_ref/t for each
/// pixel, must explain that: what is left (0.326) is the maker's own vignetting term and quantization. The ratio
/// is free of scale, so the median that is removed does not change the spread. Pixels count where the value is
/// valid, the maker gives one, and its confidence does not say invalid (bit 0); they are the same before and after.
#[test]
fn pixels_of_unlike_integration_times_become_consistent() {
    let Some(data) = data() else { return };
    let folder = tempfile::tempdir().unwrap();
    let (input, output) = (data.join("ifm-o3d303"), folder.path().join("standardized"));
    run(&[&"standardize", &input, &"-o", &output, &"--time", &"linear", &"--distance", &"none"]);
    assert_nan_is_invalid(&output);
    let mut recorded = isolux_io::open(&input).unwrap();
    let mut standardized = isolux_io::open(&output).unwrap();
    let (mut raw, mut ours, mut long_times, mut pixels) = (Vec::new(), Vec::new(), 0, 0);
    let mut frame = Frame::new(recorded.metadata().shape);
    for index in 0..recorded.metadata().frame_count.unwrap() {
        recorded.read_frame(index, Channels::AMPLITUDE | Channels::INTEGRATION_TIME, &mut frame).unwrap();
        let vendor = image(&mut *recorded, "vendor_amplitude", index);
        let confidence = image(&mut *recorded, "vendor_confidence", index);
        let values = image(&mut *standardized, "standardized_amplitude", index);
        let IntegrationTime::PerPixel(times) = &frame.integration_time_us else { panic!("no map of times") };
        for pixel in 0..values.len() {
            pixels += 1;
            if values[pixel].is_nan() || vendor[pixel] <= 0.0 || confidence[pixel] as u8 & 1 != 0 {
                continue;
            }
            let log_ratio = |value: f32| f64::from(value / vendor[pixel]).ln();
            raw.push(log_ratio(frame.amplitude.values()[pixel]));
            ours.push(log_ratio(values[pixel]));
            long_times += usize::from(times.values()[pixel] > 1000.0);
        }
    }
    let (before, after) = (spread(&raw), spread(&ours));
    println!("spread of ln(ours / vendor): {before:.3} raw, {after:.3} standardized, {} pixels", ours.len());
    // Both exposures are there in number, and nearly all pixels count: nothing is won by masking.
    assert!(ours.len() as f64 > 0.99 * f64::from(pixels), "{} of {pixels}", ours.len());
    let share = long_times as f64 / ours.len() as f64;
    assert!((0.5..0.9).contains(&share), "{share}");
    assert!((before - 1.43).abs() < 0.01, "{before}");
    assert!(after <= 0.33, "{after}");
}
