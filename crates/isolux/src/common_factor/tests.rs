//! The common factor of simulated frames of known exposures.

use super::*;
use crate::frame::{Frame, IntegrationTime, Plane, Shape};
use crate::numerics::hash::splitmix64;

const SHAPE: Shape = Shape::new(60, 80);

/// Twelve uniform numbers make a normal one.
fn normal(seed: u64, pixel: usize) -> f64 {
    let uniform =
        |part: u64| (splitmix64(seed << 40 | (12 * pixel as u64 + part)) >> 11) as f64 / (1u64 << 53) as f64;
    (0..12).map(uniform).sum::<f64>() - 6.0
}

/// A slanted wall of three materials, seen from `shift` columns to the left, `gain` times as bright.
fn frame(number: u64, gain: f64, noise_dn: f64, time_us: Option<f64>, shift: usize) -> Frame {
    let mut frame = Frame::new(SHAPE);
    let distance = |column: usize| 1.0 + 0.02 * ((column + shift) % 100) as f64;
    let amplitude = |row: usize, column: usize| {
        let reflectivity = 0.2 + 0.3 * ((row / 10 + (column + shift) / 10) % 3) as f64;
        let pixel = row * SHAPE.width + column;
        (gain * 400.0 * reflectivity / distance(column).powi(2) + noise_dn * normal(number, pixel)) as f32
    };
    frame.amplitude = Plane::from_fn(SHAPE, amplitude);
    frame.distance_m = Some(Plane::from_fn(SHAPE, |_, column| distance(column) as f32));
    frame.integration_time_us = time_us.map_or(IntegrationTime::Unknown, IntegrationTime::PerFrame);
    frame.flag_amplitude(None);
    frame
}

fn course(frames: impl IntoIterator<Item = Frame>) -> Course {
    let grid = Grid::new(SHAPE);
    let mut course = Course::new(grid, Times::Explain);
    frames.into_iter().for_each(|frame| course.push(Look::of_frame(grid, &frame)));
    course
}

#[test]
fn an_unrecorded_exposure_is_told_with_its_range() {
    let gains = [1.0, 0.5, 2.0, 1.0, 0.7];
    let found = course((0..5).map(|i| frame(i, gains[i as usize], 3.0, None, 0))).unexplained().unwrap();
    assert_eq!((found.frames, found.claim), (5, ExposureClaim::NotRecorded));
    // The median of 2400 pixels of a noise of 2 to 10 %: a few thousandths.
    assert!((found.least / 0.5 - 1.0).abs() < 0.01 && (found.largest / 2.0 - 1.0).abs() < 0.01, "{found:?}");
}

#[test]
fn noise_alone_is_no_exposure() {
    // Down to a signal-to-noise ratio of about 2 in the dim half.
    for noise_dn in [0.0, 3.0, 30.0] {
        let frames = (0..12).map(|i| frame(i, 1.0, noise_dn, None, 0));
        assert_eq!(course(frames).unexplained(), None, "{noise_dn}");
    }
}

#[test]
fn recorded_times_explain_what_follows_them() {
    let times_us = [500.0, 1000.0, 500.0, 2000.0, 1000.0, 2000.0];
    let of = |gain: fn(u64, f64) -> f64| {
        course((0..6).map(|i| frame(i, gain(i, times_us[i as usize]), 3.0, Some(times_us[i as usize]), 0)))
            .unexplained()
    };
    assert_eq!(of(|_, time_us| time_us / 1000.0), None);
    // Saturation makes amplitudes grow by less.
    assert_eq!(of(|_, time_us| (time_us / 1000.0).powf(0.6)), None);
    let found = of(|i, time_us| time_us / 1000.0 * if i % 2 == 0 { 1.0 } else { 1.5 });
    assert_eq!(found.unwrap().claim, ExposureClaim::Recorded);
    assert!(of(|_, time_us| (time_us / 1000.0).powf(1.5)).is_some(), "faster than the times");
}

#[test]
fn one_stated_time_is_contradicted_and_movement_is_not() {
    let jump = |i: u64| if i < 4 { 1.0 } else { 1.3 };
    let found = course((0..8).map(|i| frame(i, jump(i), 3.0, Some(700.0), 0))).unexplained();
    assert_eq!(found.unwrap().claim, ExposureClaim::Constant);
    assert_eq!(course((0..8).map(|i| frame(i, 1.0, 3.0, None, 4 * i as usize))).unexplained(), None);
}

#[test]
fn stretched_frames_are_told_from_holes_and_codes() {
    let spans = |edit: &dyn Fn(usize, &mut [f32])| {
        let mut spans = Spans::default();
        for i in 0..6 {
            let mut frame = frame(i, 1.0, 3.0, None, 0);
            edit(i as usize, frame.amplitude.values_mut());
            spans.push(&frame);
        }
        spans
    };
    let stretch = |i: usize, values: &mut [f32]| {
        values[100 + i] = 2000.0;
        values[7] = 0.0;
    };
    let found = spans(&stretch).stretched(false).unwrap();
    assert_eq!((found.least_dn, found.largest_dn, found.frames), (Some(0.0), 2000.0, 6));
    let coded = |_: usize, values: &mut [f32]| {
        values[100..120].fill(2000.0);
        values[7] = 0.0;
    };
    assert_eq!(spans(&coded).stretched(false), None);
    assert_eq!(spans(&coded).stretched(true), None, "twenty pixels at a code");
    assert_eq!(spans(&|_, _| ()).stretched(true), None, "spans that differ");
}
