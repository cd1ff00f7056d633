//! Phase samples of all layouts. The expected numbers were computed with NumPy.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "tests fail by panicking")]

mod common;

use common::{Array, Folder, header, read};
use isolux::{Channels, PixelFlags};

/// A phase of three pixels, 5·(6 + 8i), 5·(−8 + 6i), 5·(−6 − 8i), and its distances at 20 MHz.
const I: [f64; 3] = [30.0, -40.0, -30.0];
const Q: [f64; 3] = [40.0, 30.0, -40.0];
const DISTANCES_M: [f64; 3] = [1.106_111_39, 2.979_814_25, 4.853_517_11];
const REVERSED_M: [f64; 3] = [6.388_700_06, 4.514_997_2, 2.641_294_34];

/// Bins of 800 cos(φ − kπ/2) + 2000 at 0.4, 3.7 and 9.2 m, at 60 and at 75 MHz.
const TWICE: [[[f64; 3]; 4]; 2] = [
    [[2428.0, 1206.0, 1671.0], [2676.0, 2095.0, 1271.0], [1572.0, 2794.0, 2329.0], [1324.0, 1905.0, 2729.0]],
    [[2247.0, 2475.0, 1362.0], [2761.0, 1357.0, 1517.0], [1753.0, 1525.0, 2638.0], [1239.0, 2643.0, 2483.0]],
];

fn complex(descr: &str, dims: &[usize], parts: impl Iterator<Item = (f64, f64)>) -> Vec<u8> {
    let mut bytes = header(descr, false, dims);
    for value in parts.flat_map(|(re, im)| [re, im]) {
        match descr {
            "<c8" => bytes.extend((value as f32).to_le_bytes()),
            ">c8" => bytes.extend((value as f32).to_be_bytes()),
            _ => bytes.extend(value.to_le_bytes()),
        }
    }
    bytes
}

fn expect_close(found: &[f32], expected: &[f64], tolerance: f64) {
    for (&found, expected) in found.iter().zip(expected) {
        assert!((f64::from(found) - expected).abs() < tolerance, "{found} {expected}");
    }
    assert_eq!(found.len(), expected.len());
}

#[test]
fn i_and_q_give_amplitude_and_distance_in_every_form() {
    let pairs = || I.into_iter().zip(Q);
    let two: Vec<f64> = I.into_iter().chain(Q).collect();
    let forms = [
        complex("<c8", &[1, 1, 3], pairs()),
        complex(">c8", &[1, 1, 3], pairs()),
        complex("<c16", &[1, 1, 3], pairs()),
        Array::of("<i2", &[1, 2, 1, 3], &two).bytes(),
        Array::of("<f4", &[1, 2, 1, 3], &two).bytes(),
    ];
    for bytes in forms {
        for (reversed, distances_m) in [(false, DISTANCES_M), (true, REVERSED_M)] {
            let folder = Folder::new();
            folder.write("phase_samples.npy", &bytes);
            let json = format!(
                r#"{{"modulation_frequency_hz": 2e7, "phase_convention": {{"reversed": {reversed}}}}}"#
            );
            folder.write("recording.json", json.as_bytes());
            let mut recording = folder.open().unwrap();
            // Without the raw bins, nothing that needs them is offered.
            assert_eq!(recording.metadata().available, Channels::AMPLITUDE | Channels::DISTANCE);
            let frame = read(&mut *recording, 0).unwrap();
            assert_eq!(frame.amplitude.values(), [50.0; 3]);
            expect_close(frame.distance_m.unwrap().values(), &distances_m, 2e-6);
            assert_eq!(frame.phase_samples, None);
        }
    }
}

#[test]
fn i_and_q_that_clip_are_saturated_and_nothing_is_no_distance() {
    let folder = Folder::new();
    let values = [(-2047.0, 3.0), (0.0, 0.0), (5.0, 2046.0)];
    folder.write("phase_samples.npy", &complex("<c8", &[1, 1, 3], values.into_iter()));
    folder.write("recording.json", br#"{"modulation_frequency_hz": 2e7, "saturated_phase_sample": 2047}"#);
    let frame = read(&mut *folder.open().unwrap(), 0).unwrap();
    let saturated = |at: usize| frame.flags.values()[at].contains(PixelFlags::SATURATED);
    assert_eq!([0, 1, 2].map(saturated), [true, false, true]);
    assert!(frame.distance_m.as_ref().unwrap().values()[1].is_nan());
    assert!(frame.flags.values()[1].contains(PixelFlags::INVALID));
}

#[test]
fn two_frequencies_tell_distances_beyond_the_range_of_each() {
    let values =
        |order: [usize; 2]| -> Vec<f64> { order.iter().flat_map(|&set| TWICE[set].concat()).collect() };
    for (order, frequencies) in [([0, 1], "6e7, 75e6"), ([1, 0], "75e6, 60e6")] {
        let bins = Array::of("<u2", &[1, 8, 1, 3], &values(order));
        let json = format!(r#"{{"modulation_frequency_hz": [{frequencies}]}}"#);
        let folder = Folder::described(&[("phase_samples", bins)], &json);
        let frame = read(&mut *folder.open().unwrap(), 0).unwrap();
        // Rounding to whole numbers: 1 DN of 800 is 0.4 mm at 75 MHz.
        expect_close(frame.distance_m.unwrap().values(), &[0.4, 3.7, 9.2], 4e-4);
        // Amplitude and bins are those of the higher frequency.
        expect_close(frame.amplitude.values(), &[800.081_2, 799.421_0, 800.208_1], 1e-3);
        let bins = frame.phase_samples.unwrap();
        for (bin, expected) in bins.iter().zip(TWICE[1]) {
            expect_close(bin.values(), &expected, 1e-9);
        }
    }
}

#[test]
fn a_pixel_whose_frequencies_contradict_each_other_has_no_distance() {
    let mut values: Vec<f64> = TWICE.iter().flat_map(|set| set.concat()).collect();
    // 0.12 m off at 60 MHz: a quarter of the way to the next distance that fits, and no rounding.
    for (k, bin) in [2208.0, 2772.0, 1792.0, 1228.0].into_iter().enumerate() {
        values[3 * k] = bin;
    }
    let bins = Array::of("<u2", &[1, 8, 1, 3], &values);
    let folder =
        Folder::described(&[("phase_samples", bins)], r#"{"modulation_frequency_hz": [60e6, 75e6]}"#);
    let frame = read(&mut *folder.open().unwrap(), 0).unwrap();
    let distances_m = frame.distance_m.unwrap();
    assert!(distances_m.values()[0].is_nan(), "{:?}", distances_m.values());
    expect_close(&distances_m.values()[1..], &[3.7, 9.2], 4e-4);
    // The amplitude is as good as before.
    assert!(!frame.flags.values()[0].contains(PixelFlags::INVALID));
}

#[test]
fn a_signed_bin_clips_at_either_side() {
    let bins = Array::of("<i2", &[1, 4, 1, 2], &[5.0, -2047.0, 9.0, 7.0, -5.0, 3.0, -9.0, 2.0]);
    let folder = Folder::described(&[("phase_samples", bins)], r#"{"saturated_phase_sample": 2047}"#);
    let frame = read(&mut *folder.open().unwrap(), 0).unwrap();
    assert_eq!(frame.flags.values()[1], PixelFlags::SATURATED);
    assert!(!frame.flags.values()[0].contains(PixelFlags::SATURATED));
}

#[test]
fn what_does_not_fit_is_refused_with_field_and_reason() {
    let bins = |count: usize| Array::counting("<u2", &[2, count, 3, 4]).bytes();
    let iq = || complex("<c8", &[2, 3, 4], (0..24).map(|at| (f64::from(at), 1.0)));
    let cases: [(Vec<u8>, &str, &str); 11] = [
        (bins(8), "{}", "field `modulation_frequency_hz`: found nothing, expected [first, second]"),
        (bins(8), r#"{"modulation_frequency_hz": 6e7}"#, "found one frequency, expected [first, second]"),
        (bins(4), r#"{"modulation_frequency_hz": [6e7, 8e7]}"#, "found two frequencies, expected one"),
        (iq(), r#"{"modulation_frequency_hz": [6e7, 8e7]}"#, "found two frequencies, expected one"),
        (bins(8), r#"{"modulation_frequency_hz": [6e7, 6e7]}"#, "found [60000000.0,60000000.0]"),
        (bins(8), r#"{"modulation_frequency_hz": [6e7, 0]}"#, "two unlike ones"),
        (bins(8), r#"{"modulation_frequency_hz": [6e7]}"#, "two unlike ones"),
        (bins(8), r#"{"modulation_frequency_hz": [6e7, 6.01e7]}"#, "common divisor is at least 1/64"),
        (bins(5), "{}", "expected (N, 4, H, W), (N, 8, H, W) of two frequencies, or (N, 2, H, W) of I and Q"),
        (
            iq(),
            r#"{"phase_convention": {"order": [1, 0, 2, 3]}}"#,
            "found the order [1, 0, 2, 3], expected no order",
        ),
        (complex("<c8", &[2, 4, 3, 4], (0..96).map(|_| (0.0, 0.0))), "{}", "of complex numbers"),
    ];
    for (bytes, json, expected) in cases {
        let folder = Folder::new();
        folder.write("phase_samples.npy", &bytes);
        folder.write("recording.json", json.as_bytes());
        let message = folder.open().err().expect(expected).to_string();
        assert!(message.contains(expected), "{message}");
    }
    for name in ["amplitude", "distance", "intensity", "vendor_amplitude"] {
        let folder = Folder::with(&[("phase_samples", Array::counting("<u2", &[2, 4, 3, 4]))]);
        folder.write(&format!("{name}.npy"), &iq());
        let message = folder.open().err().expect(name).to_string();
        assert!(
            message.contains(name) && message.contains("only `phase_samples` may be complex"),
            "{message}"
        );
    }
}

#[test]
fn extra_channels_may_be_complex_and_are_no_image() {
    let folder = Folder::with(&[("amplitude", Array::counting("<u2", &[1, 1, 2]))]);
    let bytes = complex("<c8", &[1, 1, 2], [(1.0, 2.0), (3.0, 4.0)].into_iter());
    folder.write("field.npy", &bytes);
    let mut recording = folder.open().unwrap();
    let mut raw = Vec::new();
    recording.read_raw("field", 0, &mut raw).unwrap();
    assert_eq!(raw, bytes[bytes.len() - 16..]);
    let mut plane = isolux::Plane::filled(isolux::Shape::new(1, 2), 0.0);
    assert!(recording.read_plane("field", 0, &mut plane).is_err());
}
