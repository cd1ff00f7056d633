//! Standardized frames equal a naive implementation of the whole chain.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "tests fail by panicking")]

mod common;

use common::standardize::next;
use common::{builtin, calibrate, naive_chain, render};
use isolux::calibrate::CalibrateSettings;
use isolux::standardize::Method;
use isolux::{Calibration, Channels, Choice, Frame, IntegrationTime, PixelFlags, Plane, Standardizer};
use isolux_camera::SimulatedFrame;

const CHANNELS: Channels = Channels::AMPLITUDE.union(Channels::DISTANCE).union(Channels::INTEGRATION_TIME);

fn paper(calibration: &Calibration) -> Standardizer {
    let choice = Choice { method: Method::Paper, ..Choice::default() };
    Standardizer::plan(&choice, Some(calibration), CHANNELS).unwrap()
}

/// The calibration of the simulated SR-3100 from its two small sweeps.
fn calibration() -> Calibration {
    let sweep = |scene| render(&builtin(scene, 1));
    calibrate(&CalibrateSettings::default(), &sweep("wall-sweep-smoke"), &sweep("board-distances-smoke"))
}

/// Everything that a pixel can be: unmeasured in every way, too near, too far, of another time.
fn spoil(frame: &mut Frame) {
    let distances = frame.distance_m.as_mut().unwrap().values_mut();
    for (index, odd) in [f32::NAN, 0.0, -1.0, f32::INFINITY, 0.02, 0.3, 6.9].into_iter().enumerate() {
        distances.iter_mut().skip(10 + index).step_by(97).for_each(|distance| *distance = odd);
    }
    for (index, odd) in [f32::NAN, 0.0, -3.0, f32::INFINITY].into_iter().enumerate() {
        frame.amplitude.values_mut().iter_mut().skip(index).step_by(89).for_each(|value| *value = odd);
    }
    frame.flags.values_mut()[5000] |= PixelFlags::INVALID | PixelFlags::SATURATED;
    frame.flags.values_mut()[5001] |= PixelFlags::SATURATED;
    frame.flag_amplitude(None);
}

/// Every thirtieth pixel up to 40 times as bright, evenly: too few for any bin to qualify, and more than the 2 %
/// that may be called specular.
fn spread_out(frame: &mut Frame) {
    let values = frame.amplitude.values_mut().iter_mut();
    values.enumerate().step_by(30).for_each(|(index, value)| *value *= 1.0 + (index % 1000) as f32 / 25.0);
}

/// The fast path in f32 and blocks against the naive one in f64 and sorted lists. A value may differ by the
/// roundings that the oracle counts; a pixel that the oracle finds that near to the cutoff may fall on either
/// side of it.
#[test]
fn the_chain_equals_the_naive_oracle_pixel_by_pixel() {
    let calibration = calibration();
    let standardizer = paper(&calibration);
    let mut stream = standardizer.stream();
    let highlights = builtin("highlights", 4);
    let mut simulated = SimulatedFrame::new(highlights.shape());
    let times = [
        IntegrationTime::PerFrame(2000.0),
        IntegrationTime::PerFrame(150.0),
        IntegrationTime::PerFrame(60_000.0),
        IntegrationTime::PerPixel(Plane::from_fn(highlights.shape(), |row, column| {
            [125.0, 5000.0, f32::NAN, 8200.0, 0.0, 50_000.0][(row / 7 + column / 5) % 6]
        })),
        IntegrationTime::PerFrame(4200.0),
    ];
    for (number, time) in times.into_iter().enumerate() {
        highlights.render_frame(3 * (number % 3), &mut simulated).unwrap();
        let mut frame = simulated.frame.clone();
        frame.integration_time_us = time;
        spoil(&mut frame);
        if number == 4 {
            spread_out(&mut frame);
        }
        let out = next(&mut stream, &frame).unwrap();
        let summary = out.summary;
        let naive = naive_chain::standardize(&frame, &calibration);
        let cutoff = naive.cutoff.unwrap_or(f64::INFINITY);
        let found = summary.specular_cutoff.map_or(f64::INFINITY, f64::from);
        let widest = naive.tolerance.iter().fold(0.0, |widest: f64, &t| widest.max(t));
        assert!(
            found == cutoff || (found / cutoff - 1.0).abs() <= widest,
            "frame {number}: {found} {cutoff}"
        );
        let mut undecided = 0;
        for (index, (&value, &flags)) in out.amplitude.values().iter().zip(out.flags.values()).enumerate() {
            let (expected, tolerance) = (naive.values[index], naive.tolerance[index] + widest);
            let deviation = (f64::from(value) / expected - 1.0).abs();
            assert_eq!(value.is_nan(), expected.is_nan(), "frame {number}, pixel {index}");
            assert!(value.is_nan() || deviation <= tolerance, "frame {number}, pixel {index}: {deviation:e}");
            let mut differing = flags ^ naive.flags[index];
            if (expected / cutoff - 1.0).abs() <= tolerance && differing == PixelFlags::SPECULAR {
                undecided += 1;
                differing = PixelFlags::empty();
            }
            assert!(
                differing.is_empty(),
                "frame {number}, pixel {index}: {flags:?} {:?}",
                naive.flags[index]
            );
        }
        assert!(undecided <= 1, "frame {number}: {undecided} pixels at the cutoff");
        let specular = out.flags.values().iter().filter(|flags| flags.contains(PixelFlags::SPECULAR)).count();
        assert_eq!(summary.specular, specular);
        // Not an empty comparison: only the time above the table leaves nothing.
        assert_eq!(summary.valid == 0, number == 2, "frame {number}: {summary:?}");
        assert_eq!(specular == 0, number == 2, "frame {number}: {summary:?}");
    }
}
