//! What a chain makes of the denoised distance. What denoising is worth: `isolux-experiments`'s `tests/denoise.rs`.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "tests fail by panicking")]

mod common;

use common::standardize::standardize;
use isolux::standardize::{DenoiseStep, TimeStep};
use isolux::{Channels, Choice, DenoiseRule, Frame, PixelFlags, Plane, Shape, Standardizer};

/// What counts as outside the calibrated distances is decided by the denoised distance.
#[test]
fn the_range_is_that_of_the_denoised_distance() {
    let shape = Shape::new(9, 9);
    let choice = Choice {
        denoise: Some(DenoiseStep::Smooth(DenoiseRule::Median)),
        time: Some(TimeStep::None),
        ..Choice::default()
    };
    let channels = Channels::AMPLITUDE | Channels::DISTANCE;
    let calibration = common::strategies::calibration();
    let mut frame = Frame::new(shape);
    frame.amplitude.fill(100.0);
    // One pixel beyond the calibrated 3 m.
    frame.distance_m =
        Some(Plane::from_fn(shape, |row, column| if (row, column) == (4, 4) { 3.5 } else { 2.0 }));
    let outside = |choice| {
        let standardizer = Standardizer::plan(&choice, Some(&calibration), channels).unwrap();
        let out = standardize(&standardizer, &frame);
        assert_eq!(
            out.summary.distance_extrapolated > 0,
            out.flags.get(4, 4).unwrap().contains(PixelFlags::DISTANCE_OUT_OF_RANGE)
        );
        out.summary.distance_extrapolated
    };
    assert_eq!(outside(Choice { denoise: None, ..choice }), 1);
    assert_eq!(outside(choice), 0);
}
