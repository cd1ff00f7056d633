//! Awkward but good input, and what a frame makes of it.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "tests fail by panicking")]

mod common;

use common::{Array, Folder, read};
use isolux::{Channels, Frame, IntegrationTime, PixelFlags, Shape};
use isolux_io::recording::Storage;

const TYPES: [&str; 19] = [
    "|u1", "<u2", ">u2", "<u4", ">u4", "<u8", ">u8", "|i1", "<i2", ">i2", "<i4", ">i4", "<i8", ">i8", "<f4",
    ">f4", "<f8", ">f8", "<u1",
];

#[test]
fn every_type_byte_order_and_array_order_reads_the_same() {
    for descr in TYPES {
        for fortran in [false, true] {
            let mut array = Array::counting(descr, &[4, 3, 5]);
            array.fortran = fortran;
            let folder = Folder::with(&[("amplitude", array)]);
            let mut recording = folder.open().unwrap();
            assert_eq!(recording.metadata().shape, Shape::new(3, 5));
            for index in [0, 1, 2, 3, 1, 0, 3] {
                let frame = read(&mut *recording, index).unwrap();
                let expected: Vec<_> = (0..15).map(|pixel| (index * 15 + pixel + 1) as f32).collect();
                assert_eq!(frame.amplitude.values(), expected, "{descr} {fortran} {index}");
            }
        }
    }
}

#[test]
fn one_frame_and_tiny_images_are_recordings() {
    for dims in [[1, 3, 3], [1, 1, 1], [2, 1, 4]] {
        let folder = Folder::with(&[("amplitude", Array::counting("<u2", &dims))]);
        let mut recording = folder.open().unwrap();
        assert_eq!(recording.metadata().frame_count, Some(dims[0]));
        assert_eq!(read(&mut *recording, 0).unwrap().amplitude.values()[0], 1.0);
    }
}

#[test]
fn integers_are_millimetres_and_floats_metres_unless_told_otherwise() {
    let read_distance = |descr: &str, json: &str| {
        let distance = Array::of(descr, &[1, 1, 4], &[1500.0, 0.0, 1.0, 12345.0]);
        let arrays = [("amplitude", Array::counting("<u2", &[1, 1, 4])), ("distance", distance)];
        let folder = Folder::described(&arrays, json);
        read(&mut *folder.open().unwrap(), 0).unwrap().distance_m.unwrap().values().to_vec()
    };
    let (metres, millimetres) = ([1500.0, 0.0, 1.0, 12345.0], [1.5, 0.0, 0.001, 12.345]);
    assert_eq!(read_distance("<u2", "{}"), millimetres);
    assert_eq!(read_distance("<f4", "{}"), metres);
    assert_eq!(read_distance(">u2", r#"{"distance_unit": "m"}"#), metres);
    assert_eq!(read_distance("<f8", r#"{"distance_unit": "mm"}"#), millimetres);
}

#[test]
fn depth_becomes_radial_and_invalid_stays_invalid() {
    let depth = Array::of("<f4", &[1, 1, 3], &[2.0, 0.0, -1.0]);
    let arrays = [("amplitude", Array::counting("<u2", &[1, 1, 3])), ("distance", depth)];
    let json = r#"{"distance_kind": "z", "intrinsics": {"fx": 1, "fy": 1, "cx": 1, "cy": 0}}"#;
    let folder = Folder::described(&arrays, json);
    let frame = read(&mut *folder.open().unwrap(), 0).unwrap();
    // The first pixel lies one focal length beside the axis: √2 times as far as deep.
    assert_eq!(frame.distance_m.unwrap().values(), [2.0 * 2f32.sqrt(), 0.0, -(2f32.sqrt())]);
}

#[test]
fn codes_zeros_and_nan_are_flagged_and_their_neighbours_are_not() {
    let values = [7.0, 65535.0, 0.0, f64::NAN, 65534.0, -3.0];
    let folder = Folder::described(
        &[("amplitude", Array::of("<f4", &[1, 2, 3], &values))],
        r#"{"saturated_amplitude": 65535}"#,
    );
    let frame = read(&mut *folder.open().unwrap(), 0).unwrap();
    let (good, invalid) = (PixelFlags::empty(), PixelFlags::INVALID);
    let expected = [good, invalid | PixelFlags::SATURATED, invalid, invalid, good, invalid];
    assert_eq!(frame.flags.values(), expected);
}

#[test]
fn flags_of_the_frame_before_are_forgotten() {
    let values = [0.0, 5.0, 5.0, 0.0];
    let folder = Folder::with(&[("amplitude", Array::of("|u1", &[2, 1, 2], &values))]);
    let mut recording = folder.open().unwrap();
    let mut frame = Frame::new(Shape::new(9, 9));
    for (index, expected) in [(0, [true, false]), (1, [false, true])] {
        recording.read_frame(index, Channels::AMPLITUDE, &mut frame).unwrap();
        let invalid: Vec<_> = frame.flags.values().iter().map(|f| f.contains(PixelFlags::INVALID)).collect();
        assert_eq!(invalid, expected);
    }
}

#[test]
fn times_are_per_frame_per_pixel_constant_or_unknown() {
    let amplitude = ("amplitude", Array::counting("<u2", &[2, 1, 2]));
    let time = |array: Option<Array>, json: &str| {
        let mut arrays = vec![amplitude.clone()];
        arrays.extend(array.map(|array| ("integration_time_us", array)));
        let folder = Folder::described(&arrays, json);
        let mut recording = folder.open().unwrap();
        [0, 1].map(|index| read(&mut *recording, index).unwrap().integration_time_us)
    };
    use IntegrationTime::{PerFrame, PerPixel, Unknown};
    assert_eq!(time(None, "{}"), [Unknown, Unknown]);
    assert_eq!(time(None, r#"{"integration_time_us": 0.5}"#), [PerFrame(0.5), PerFrame(0.5)]);
    let per_frame = Array::of("<f8", &[2], &[8200.0, f64::NAN]);
    assert_eq!(time(Some(per_frame), "{}"), [PerFrame(8200.0), Unknown]);
    let per_pixel = Array::of(">u2", &[2, 1, 2], &[30.0, 5000.0, 0.0, 400.0]);
    let [PerPixel(first), PerPixel(second)] = time(Some(per_pixel), "{}") else { panic!("no maps") };
    assert_eq!((first.values(), second.values()), (&[30.0, 5000.0][..], &[0.0, 400.0][..]));
}

/// Bins of amplitude 100 with a phase of 90 degrees: A2 is the largest.
const QUARTER: [f64; 4] = [200.0, 300.0, 200.0, 100.0];

fn bins_in_order(order: [usize; 4]) -> Array {
    let mut values = [0.0; 4];
    order.iter().zip(QUARTER).for_each(|(&position, value)| values[position] = value);
    Array::of("<u2", &[1, 4, 1, 1], &values)
}

#[test]
fn amplitude_and_distance_come_from_the_bins_in_any_order_and_sign() {
    let range_m = 299_792_458.0 / (2.0 * 20e6);
    for (order, reversed, fraction) in
        [([0, 1, 2, 3], false, 0.25), ([2, 0, 3, 1], false, 0.25), ([0, 1, 2, 3], true, 0.75)]
    {
        let json = format!(
            r#"{{"modulation_frequency_hz": 2e7, "phase_convention": {{"order": {order:?}, "reversed": {reversed}}}}}"#
        );
        let folder = Folder::described(&[("phase_samples", bins_in_order(order))], &json);
        let mut recording = folder.open().unwrap();
        let computed: Vec<_> = recording
            .metadata()
            .channels
            .iter()
            .filter(|channel| channel.storage == Storage::FromPhaseSamples)
            .map(|channel| channel.name.clone())
            .collect();
        assert_eq!(computed, ["amplitude", "distance"]);
        let frame = read(&mut *recording, 0).unwrap();
        assert_eq!(frame.amplitude.values(), [100.0]);
        let distance = f64::from(frame.distance_m.unwrap().values()[0]);
        // f32 holds 7.5 m to 2^-22 of it.
        assert!((distance - fraction * range_m).abs() < 1e-6 * range_m, "{order:?} {distance}");
        // Whatever the vendor's convention, the frame's bins are the paper's.
        let largest = if reversed { 3 } else { 1 };
        assert_eq!(frame.phase_samples.unwrap()[largest].values(), [300.0]);
    }
}

#[test]
fn a_clipped_bin_saturates_its_pixel_even_where_the_amplitude_is_recorded() {
    let bins =
        Array::of("<u2", &[1, 4, 1, 3], &[9.0, 9.0, 9.0, 9.0, 985.0, 9.0, 9.0, 9.0, 9.0, 9.0, 9.0, 984.0]);
    let arrays = [("phase_samples", bins), ("amplitude", Array::counting("<f4", &[1, 1, 3]))];
    let folder = Folder::described(&arrays, r#"{"saturated_phase_sample": 1000}"#);
    let mut frame = Frame::new(Shape::new(1, 3));
    folder.open().unwrap().read_frame(0, Channels::AMPLITUDE, &mut frame).unwrap();
    let good = PixelFlags::empty();
    assert_eq!(frame.flags.values(), [good, PixelFlags::SATURATED, good]);
    assert_eq!(frame.amplitude.values(), [1.0, 2.0, 3.0]);
    assert_eq!(frame.phase_samples, None);
}

#[test]
fn only_what_is_wanted_is_filled() {
    let image = |start: f64| Array::of("|u1", &[2, 1, 2], &[start, start + 1.0, start + 2.0, start + 3.0]);
    let folder = Folder::with(&[
        ("amplitude", image(1.0)),
        ("intensity", image(11.0)),
        ("target", image(2.0)),
        ("vendor_amplitude", image(21.0)),
        ("vendor_confidence", image(31.0)),
        ("timestamp_us", Array::of("<i8", &[2], &[5.0, 6.0])),
        ("world_from_camera", Array::counting("<f8", &[2, 4, 4])),
        ("phase_samples", Array::counting("<f4", &[2, 4, 1, 2])),
        ("ambient", image(41.0)),
    ]);
    let mut recording = folder.open().unwrap();
    let frame = read(&mut *recording, 1).unwrap();
    assert_eq!(frame.amplitude.values(), [3.0, 4.0]);
    assert_eq!(frame.intensity.as_ref().unwrap().values(), [13.0, 14.0]);
    assert_eq!(frame.target.as_ref().unwrap().values(), [4, 5]);
    assert_eq!(frame.vendor_amplitude.as_ref().unwrap().values(), [23.0, 24.0]);
    assert_eq!(frame.vendor_confidence.as_ref().unwrap().values(), [33.0, 34.0]);
    assert_eq!(frame.timestamp_us, Some(6.0));
    assert_eq!(frame.world_from_camera.unwrap()[3], [29.0, 30.0, 31.0, 32.0]);
    assert_eq!(frame.phase_samples.as_ref().unwrap()[3].values(), [15.0, 16.0]);
    frame.check_shapes().unwrap();

    let mut frame = frame;
    recording.read_frame(0, Channels::TARGET, &mut frame).unwrap();
    let mut expected = Frame::new(Shape::new(1, 2));
    expected.target = frame.target.clone();
    assert!(frame.amplitude.values().iter().all(|value| value.is_nan()));
    frame.amplitude = expected.amplitude.clone();
    frame.amplitude.fill(0.0);
    expected.amplitude.fill(0.0);
    assert_eq!(frame, expected);
}

#[test]
fn any_channel_is_read_verbatim_or_as_an_image() {
    let folder = Folder::with(&[
        ("amplitude", Array::counting("<u2", &[2, 1, 2])),
        ("ambient", Array::counting(">u2", &[2, 1, 2]).fortran()),
    ]);
    let mut recording = folder.open().unwrap();
    let mut bytes = vec![99];
    recording.read_raw("ambient", 1, &mut bytes).unwrap();
    assert_eq!(bytes, [3, 0, 4, 0]);
    let mut plane = isolux::Plane::filled(Shape::new(1, 1), 0.0);
    recording.read_plane("ambient", 0, &mut plane).unwrap();
    assert_eq!(plane.values(), [1.0, 2.0]);
    let message = recording.read_raw("amplitudes", 0, &mut bytes).unwrap_err().to_string();
    assert!(message.contains("no channel `amplitudes`; it holds `ambient` and `amplitude`"), "{message}");
    let message = recording.read_raw("ambient", 2, &mut bytes).unwrap_err().to_string();
    assert!(message.contains("has no frame 2: it holds 2"), "{message}");
}

#[test]
fn a_standardized_recording_without_its_input_is_still_described() {
    let folder = Folder::with(&[
        ("standardized_amplitude", Array::counting("<f4", &[2, 1, 2])),
        ("flags", Array::counting("<u2", &[2, 1, 2])),
    ]);
    let mut recording = folder.open().unwrap();
    assert_eq!(recording.metadata().frame_count, Some(2));
    assert!(!recording.metadata().available.contains(Channels::AMPLITUDE));
    let message = read(&mut *recording, 0).unwrap_err().to_string();
    assert!(message.contains("found no `amplitude` and no `phase_samples`"), "{message}");
}

#[test]
fn hidden_files_and_folders_beside_the_channels_are_left_alone() {
    let folder = Folder::with(&[("amplitude", Array::counting("<u2", &[2, 1, 2]))]);
    folder.write("._amplitude.npy", b"what a file manager leaves");
    folder.write("notes.txt", b"mine");
    std::fs::create_dir(folder.join("pictures")).unwrap();
    assert_eq!(folder.open().unwrap().metadata().channels.len(), 1);
}
