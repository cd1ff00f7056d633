//! `isolux diagnose` on simulated streams whose corrections are known, and on recordings of real cameras.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::print_stdout,
    reason = "tests fail by panicking"
)]

use std::path::{Path, PathBuf};
use std::process::Command;

use isolux::{Frame, IntegrationTime, Shape};
use isolux_camera::{CameraModel, Scene, SimulatedFrame, Simulation};
use isolux_io::{ChannelSpec, ElementType, RecordingInfo, RecordingWriter};
use serde_json::Value;

/// A built-in scene before a camera with an eighth of the pixels (the middle of the image): fast.
fn render(scene: &str) -> Vec<SimulatedFrame> {
    let scene = Scene::builtin(scene).unwrap();
    let mut model = CameraModel::preset(&scene.camera).unwrap();
    (model.height, model.width) = (50, 60);
    (model.intrinsics.cy, model.intrinsics.cx) = (24.5, 29.5);
    let simulation = Simulation::new(model, scene, 1).unwrap();
    let mut frames = Vec::new();
    simulation.render_frames(0..simulation.len(), &mut frames).unwrap();
    frames
}

fn time_us(frame: &Frame) -> f64 {
    match frame.integration_time_us {
        IntegrationTime::PerFrame(time_us) => time_us,
        _ => panic!("no single integration time"),
    }
}

/// The value of a pixel.
type Law = dyn Fn(&Frame, usize) -> f32;

/// What of the frames is recorded, and how.
#[derive(Default)]
struct Stream<'a> {
    /// Maps the amplitude of a pixel.
    amplitude: Option<&'a Law>,
    vendor: Option<&'a Law>,
    time: Option<&'a Law>,
    phase_samples: bool,
    target: bool,
}

impl Stream<'_> {
    fn write(&self, folder: &Path, frames: &[SimulatedFrame]) -> PathBuf {
        let path = folder.join("stream");
        let shape = frames[0].frame.shape();
        let bins = vec![4, shape.height, shape.width];
        let mut channels = vec![image("amplitude", shape), image("distance", shape)];
        channels.push(match self.time {
            Some(_) => image("integration_time_us", shape),
            None => ChannelSpec::number("integration_time_us", ElementType::F64),
        });
        channels.extend(self.vendor.map(|_| image("vendor_amplitude", shape)));
        channels.extend(self.target.then(|| ChannelSpec::image("target", ElementType::U8, shape)));
        let bins = ChannelSpec { name: "phase_samples".into(), element: ElementType::U16, frame_dims: bins };
        channels.extend(self.phase_samples.then_some(bins));
        let mut writer = RecordingWriter::create(&path, frames.len(), channels, true).unwrap();
        for simulated in frames {
            let frame = &simulated.frame;
            let plane =
                |law: &Law| -> Vec<f32> { (0..shape.pixels()).map(|index| law(frame, index)).collect() };
            writer.push("amplitude", &plane(self.amplitude.unwrap_or(&raw))).unwrap();
            writer.push("distance", frame.distance_m.as_ref().unwrap().values()).unwrap();
            match self.time {
                Some(time) => writer.push("integration_time_us", &plane(time)).unwrap(),
                None => writer.push("integration_time_us", &[time_us(frame)]).unwrap(),
            }
            if let Some(vendor) = self.vendor {
                writer.push("vendor_amplitude", &plane(vendor)).unwrap();
            }
            if self.target {
                writer.push("target", frame.target.as_ref().unwrap().values()).unwrap();
            }
            if self.phase_samples {
                let bins: Vec<u16> =
                    simulated.phase_samples.iter().flat_map(|bin| bin.values()).copied().collect();
                writer.push("phase_samples", &bins).unwrap();
            }
        }
        writer.finish(&RecordingInfo::default()).unwrap();
        path
    }

    fn diagnose(&self, frames: &[SimulatedFrame]) -> Value {
        let folder = tempfile::tempdir().unwrap();
        json(&self.write(folder.path(), frames))
    }
}

fn image(name: &str, shape: Shape) -> ChannelSpec {
    ChannelSpec::image(name, ElementType::F32, shape)
}

fn raw(frame: &Frame, index: usize) -> f32 {
    frame.amplitude.values()[index]
}

fn output(recording: &Path, json: bool) -> String {
    let mut command = Command::new(env!("CARGO_BIN_EXE_isolux"));
    command.arg("diagnose").arg(recording).args(json.then_some("--json"));
    let output = command.output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

fn json(recording: &Path) -> Value {
    serde_json::from_str(&output(recording, true)).unwrap()
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("no number: {value}"))
}

/// The finding of this name.
fn finding<'a>(told: &'a Value, name: &str) -> &'a Value {
    let findings = told["diagnosis"]["findings"].as_array().unwrap();
    findings
        .iter()
        .find(|finding| finding["finding"] == name)
        .unwrap_or_else(|| panic!("no {name} in {findings:?}"))
}

fn names(told: &Value) -> Vec<&str> {
    told["diagnosis"]["findings"].as_array().unwrap().iter().map(|f| f["finding"].as_str().unwrap()).collect()
}

#[test]
fn a_raw_stream_is_raw_and_the_same_standardized_is_corrected() {
    let frames = render("board-distances-smoke");
    let told = Stream { target: true, ..Stream::default() }.diagnose(&frames);
    assert_eq!(told["verdict"], "raw in integration time and distance");
    // The soft full well bends t¹ and, near the camera, d⁻² by some per cent; the 16 mm ring of LEDs by 0.2 %.
    assert!((number(&told["diagnosis"]["distance"]["exponent"]["value"]) + 2.0).abs() < 0.1);
    assert!((number(&told["diagnosis"]["time"]["exponent"]["value"]) - 1.0).abs() < 0.1);

    let textbook = |frame: &Frame, index: usize| {
        let distance_m = f64::from(frame.distance_m.as_ref().unwrap().values()[index]);
        (f64::from(raw(frame, index)) * 8200.0 / time_us(frame) * (distance_m / 0.75).powi(2)) as f32
    };
    let told = Stream { amplitude: Some(&textbook), target: true, ..Stream::default() }.diagnose(&frames);
    assert_eq!(told["verdict"], "already corrected for integration time and distance");

    // Only the time corrected: the distance is still in it.
    let time_only = |frame: &Frame, index: usize| raw(frame, index) * (8200.0 / time_us(frame)) as f32;
    let told = Stream { amplitude: Some(&time_only), target: true, ..Stream::default() }.diagnose(&frames);
    assert_eq!(names(&told), ["time_corrected", "distance_raw"]);
}

#[test]
fn a_gamma_curve_shrinks_both_exponents_and_phase_samples_tell_it_exactly() {
    let frames = render("board-distances-smoke");
    let root = |frame: &Frame, index: usize| 20.0 * raw(frame, index).sqrt();
    let told = Stream { amplitude: Some(&root), target: true, ..Stream::default() }.diagnose(&frames);
    assert_eq!(finding(&told, "gamma")["from_phase_samples"], false);
    // Half of what bends t¹ (see above).
    assert!((number(&finding(&told, "gamma")["gamma"]) - 0.5).abs() < 0.05);

    let told = Stream { amplitude: Some(&root), phase_samples: true, ..Stream::default() }.diagnose(&frames);
    assert_eq!(finding(&told, "gamma")["from_phase_samples"], true);
    // Only f32 rounding is between the two.
    assert!((number(&finding(&told, "gamma")["gamma"]) - 0.5).abs() < 1e-4);

    let told = Stream { phase_samples: true, ..Stream::default() }.diagnose(&frames);
    assert!(names(&told).contains(&"equals_phase_samples"));

    // Without a target, a root might as well be half a correction: not called gamma.
    let told = Stream { amplitude: Some(&root), ..Stream::default() }.diagnose(&frames);
    assert!(names(&told).contains(&"time_partly") && !names(&told).contains(&"gamma"));
}

#[test]
fn clipping_compression_and_coarse_steps_are_found() {
    let frames = render("wall-sweep-smoke");
    let clipped = |frame: &Frame, index: usize| raw(frame, index).min(4000.0);
    let told = Stream { amplitude: Some(&clipped), ..Stream::default() }.diagnose(&frames);
    assert_eq!(finding(&told, "clipped")["value_dn"], 4000.0);
    // What is clipped does not spoil the rest.
    assert!(names(&told).contains(&"time_raw"));

    let logarithm = |frame: &Frame, index: usize| 500.0 * (1.0 + raw(frame, index) / 100.0).ln();
    let told = Stream { amplitude: Some(&logarithm), ..Stream::default() }.diagnose(&frames);
    assert!(number(&finding(&told, "compressed")["high_exponent"]) < 0.5);

    let eight_bits = |frame: &Frame, index: usize| (raw(frame, index) / 100.0).round();
    let told = Stream { amplitude: Some(&eight_bits), ..Stream::default() }.diagnose(&frames);
    assert!(number(&finding(&told, "coarse")["levels"]) <= 256.0);

    let told = Stream::default().diagnose(&frames);
    assert!(!names(&told).iter().any(|name| ["clipped", "coarse"].contains(name)), "{:?}", names(&told));
}

/// r² of a pixel, by its definition.
fn radius2(shape: Shape, index: usize) -> f64 {
    let (row, column) = ((index / shape.width) as f64, (index % shape.width) as f64);
    let (height, width) = (shape.height as f64, shape.width as f64);
    ((row - (height - 1.0) / 2.0).powi(2) + (column - (width - 1.0) / 2.0).powi(2))
        / (height.hypot(width) / 2.0).powi(2)
}

const VIGNETTING: f64 = 0.3;

#[test]
fn the_vendors_scaling_is_recovered() {
    let frames = render("patches-smoke");
    let vendor = |frame: &Frame, index: usize| {
        let radial = 1.0 + VIGNETTING * radius2(frame.shape(), index);
        (f64::from(raw(frame, index)) * 8200.0 / time_us(frame) * radial) as f32
    };
    let told = Stream { vendor: Some(&vendor), ..Stream::default() }.diagnose(&frames);
    let scaling = &told["diagnosis"]["vendor_scaling"];
    // f32: 1e-7; a cubic in r² leaves (0.3 r²)⁴/4 ≤ 0.2 % of ln(1 + 0.3 r²), a tenth of it after the fit.
    assert!((number(&scaling["time"]["value"]) + 1.0).abs() < 1e-3);
    assert!(number(&scaling["distance"]["value"]).abs() < 1e-3);
    assert!((number(&scaling["radial"]["corner_factor"]["value"]) - 1.0 - VIGNETTING).abs() < 2e-3);
    assert!(number(&scaling["residual"]) < 2e-3);
    // It says nothing of the material, so nothing of the amplitude's own distance either.
    assert_eq!(told["diagnosis"]["distance"]["unavailable"], "vendor_is_no_material");
}

#[test]
fn times_that_follow_the_material_tell_the_vendor_but_not_the_amplitude() {
    let frames = &render("patches-smoke")[..1];
    let bright = |frame: &Frame, index: usize| if raw(frame, index) > 600.0 { 125.0f32 } else { 5000.0 };
    let vendor = move |frame: &Frame, index: usize| raw(frame, index) * 5000.0 / bright(frame, index);
    let told = Stream { vendor: Some(&vendor), time: Some(&bright), ..Stream::default() }.diagnose(frames);
    assert_eq!(told["diagnosis"]["time"]["unavailable"], "time_follows_material");
    let groups = &told["diagnosis"]["vendor_scaling"]["time_groups"];
    assert_eq!(groups[0]["time_us"], 125.0);
    assert!((number(&groups[0]["ratio"]) - 40.0).abs() < 1e-3, "{groups}");
}

#[test]
fn one_frame_of_an_unknown_scene_tells_little_and_says_so() {
    let frames = &render("highlights")[..1];
    let folder = tempfile::tempdir().unwrap();
    let path = Stream::default().write(folder.path(), frames);
    let told = json(&path);
    assert_eq!(told["verdict"], "raw or corrected: cannot be told");
    assert_eq!(told["diagnosis"]["time"]["unavailable"], "time_constant");
    assert_eq!(told["diagnosis"]["distance"]["unavailable"], "material_unknown");
    let text = output(&path, false);
    assert!(text.contains("verdict: raw or corrected: cannot be told"), "{text}");
    assert!(
        text.contains("what this recording cannot tell\n  integration time: all integration times are equal")
    );
    assert!(text.lines().all(|line| line.chars().count() <= 130), "{text}");
}

#[test]
fn a_missing_recording_is_an_error() {
    let output =
        Command::new(env!("CARGO_BIN_EXE_isolux")).args(["diagnose", "/nowhere/at-all"]).output().unwrap();
    assert_eq!(output.status.code(), Some(1));
    assert!(output.stdout.is_empty());
}

/// A real recording, where they are there.
fn real(name: &str) -> Option<Value> {
    let beside = || PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/data"));
    let folder = std::env::var_os("ISOLUX_DATA").map_or_else(beside, PathBuf::from);
    if folder.is_dir() {
        return Some(json(&folder.join(name)));
    }
    println!("skipped: no recordings of real cameras at {}", folder.display());
    None
}

#[test]
fn ifm_divides_by_time_and_evens_the_image_but_leaves_distance() {
    let Some(told) = real("ifm-o3d303") else { return };
    let scaling = &told["diagnosis"]["vendor_scaling"];
    // Independent regressions in NumPy give a ratio of 39.1 (r², r⁴) and 39.5 (with r⁶), d^0.014, 2.5 %.
    assert!((number(&scaling["time_groups"][0]["ratio"]) - 39.5).abs() < 1.0, "{scaling}");
    assert!((number(&scaling["time"]["value"]) + 1.0).abs() < 0.02);
    assert!(number(&scaling["distance"]["value"]).abs() < 0.1);
    assert!(number(&scaling["radial"]["corner_factor"]["low_95"]) > 2.0);
    assert!(number(&scaling["residual"]) < 0.032 && number(&scaling["residual_rms"]) < 0.032);
    assert_eq!(told["diagnosis"]["time"]["unavailable"], "time_follows_material");
    assert_eq!(told["diagnosis"]["distance"]["unavailable"], "vendor_is_no_material");
}

#[test]
fn lidars_differ_in_how_the_signal_falls_with_range() {
    let (Some(os0), Some(os2)) = (real("ouster-os0"), real("ouster-os2")) else { return };
    let exponent = |told: &Value| number(&told["diagnosis"]["distance"]["exponent"]["value"]);
    assert_eq!(os0["diagnosis"]["distance"]["evidence"]["from"], "vendor_reflectivity");
    assert!((-1.8..=-1.1).contains(&exponent(&os0)), "{}", exponent(&os0));
    assert!(exponent(&os2).abs() <= 0.35, "{}", exponent(&os2));
    // Neither is a power: d² would be wrong for both.
    assert!(names(&os0).contains(&"distance_curve") && names(&os2).contains(&"distance_curve"));
}

#[test]
fn a_checkerboard_shows_that_the_kinect_is_raw_in_distance() {
    let Some(told) = real("kinect2-checkerboard") else { return };
    let distance = &told["diagnosis"]["distance"];
    assert_eq!(distance["evidence"]["label"], 1);
    // NumPy on all pixels: −1.991; the sample and the frames' poses move it by less than the interval.
    assert!((number(&distance["exponent"]["value"]) + 2.0).abs() < 0.05, "{distance}");
    assert!(names(&told).contains(&"distance_raw") && names(&told).contains(&"saturated"));
    assert_eq!(told["diagnosis"]["time"]["unavailable"], "time_unknown");
}

#[test]
fn a_single_frame_of_a_mug_is_undetermined() {
    let Some(told) = real("azure-kinect-mug") else { return };
    assert_eq!(names(&told), ["saturated"]);
    assert_eq!(told["diagnosis"]["distance"]["unavailable"], "material_unknown");
}

#[test]
fn an_amplitude_computed_from_the_vendors_is_recognised() {
    let Some(told) = real("ifm-o3r") else { return };
    assert_eq!(finding(&told, "vendor")["exact"], true);
}
