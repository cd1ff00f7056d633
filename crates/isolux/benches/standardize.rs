//! The point-wise chain beside a copy of the same bytes, and the whole chain with its highlights, at the size of
//! an SR-3100 and at one megapixel. Run with `cargo bench -p isolux`; compare ratios, not seconds.

#![expect(clippy::expect_used, reason = "a benchmark that cannot run must stop")]

use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use isolux::standardize::{DenoiseStep, DistanceStep, SigmaStep, SpecularStep, TimeStep};
use isolux::terms::cubic::{Decay, DecayPoint};
use isolux::terms::noise::AmplitudeNoise;
use isolux::terms::{NoiseModel, Spline};
use isolux::{
    Calibration, Channels, Choice, DenoiseRule, Frame, IntegrationTime, Plane, RecordingTraits, Reference,
    Shape, Standardizer,
};

const SHAPES: [Shape; 2] = [Shape::new(144, 176), Shape::new(1000, 1000)];

fn main() {
    divan::main();
}

fn frame(shape: Shape, per_pixel: bool) -> Frame {
    let mut frame = Frame::new(shape);
    frame.amplitude = Plane::from_fn(shape, |row, column| 100.0 + ((row * 31 + column * 17) % 997) as f32);
    frame.distance_m =
        Some(Plane::from_fn(shape, |row, column| 0.5 + ((row * 13 + column * 7) % 401) as f32 / 100.0));
    frame.integration_time_us = if per_pixel {
        IntegrationTime::PerPixel(Plane::from_fn(shape, |row, column| {
            [125.0, 5000.0][(row + column / 3) % 2]
        }))
    } else {
        IntegrationTime::PerFrame(4000.0)
    };
    frame.flag_amplitude(Some(65535.0));
    frame
}

fn standardize(bencher: Bencher, shape: Shape, per_pixel: bool, specular: Option<SpecularStep>) {
    apply(bencher, shape, per_pixel, Choice { specular, ..Choice::default() });
}

/// With linear time, and eq. 5 where no other distance step is chosen.
fn apply(bencher: Bencher, shape: Shape, per_pixel: bool, choice: Choice) {
    let distance = choice.distance.or(Some(DistanceStep::Eq5));
    let choice = Choice { time: Some(TimeStep::Linear), distance, ..choice };
    let channels = Channels::AMPLITUDE | Channels::DISTANCE | Channels::INTEGRATION_TIME;
    let traits = RecordingTraits { modulation_frequency_hz: Some(20e6), ..channels.into() };
    let standardizer =
        Standardizer::plan(&choice, Some(&calibration()), traits).expect("the calibration holds the terms");
    let (frame, mut stream) = (frame(shape, per_pixel), standardizer.stream());
    bencher
        .counter(ItemsCount::new(shape.pixels()))
        .bench_local(|| stream.push(black_box(&frame)).expect("frame fits").summary);
}

/// The spline of a camera with an aliased harmonic at 20 MHz, fitted on positions from 0.3 to 4 m.
fn calibration() -> Calibration {
    let point = |i: u32| {
        let distance_m = 0.3 * (4.0f64 / 0.3).powf(f64::from(i) / 39.0);
        let harmonic = 1.0 + 0.02 * (3.353 * distance_m).cos();
        DecayPoint { distance_m, amplitude_dn: 1e3 * harmonic / (distance_m * distance_m) }
    };
    let decay = Decay { integration_time_us: None, points: (0..40).map(point).collect() };
    let mut calibration = Calibration::new(None, Reference::default());
    let (spline, _) = Spline::fit(&[decay], 0.75, Some(20e6)).expect("positions make a spline");
    calibration.terms.spline = Some(spline);
    calibration
}

/// Reads amplitude, distance and flags, writes amplitude and flags, as the chain must.
#[divan::bench(args = SHAPES)]
fn memcpy(bencher: Bencher, shape: Shape) {
    let input = vec![1u8; shape.pixels() * 6];
    let (mut output, distance) = (vec![0u8; shape.pixels() * 6], vec![1f32; shape.pixels()]);
    let mut sink = vec![0f32; shape.pixels()];
    bencher.counter(ItemsCount::new(shape.pixels())).bench_local(|| {
        black_box(&mut output).copy_from_slice(black_box(&input));
        black_box(&mut sink).copy_from_slice(black_box(&distance));
    });
}

#[divan::bench(args = SHAPES)]
fn pointwise(bencher: Bencher, shape: Shape) {
    standardize(bencher, shape, false, Some(SpecularStep::None));
}

#[divan::bench(args = SHAPES)]
fn pointwise_spline(bencher: Bencher, shape: Shape) {
    let (specular, distance) = (Some(SpecularStep::None), Some(DistanceStep::Spline));
    apply(bencher, shape, false, Choice { specular, distance, ..Choice::default() });
}

#[divan::bench(args = SHAPES)]
fn pointwise_time_per_pixel(bencher: Bencher, shape: Shape) {
    standardize(bencher, shape, true, Some(SpecularStep::None));
}

#[divan::bench(args = SHAPES)]
fn with_histogram(bencher: Bencher, shape: Shape) {
    standardize(bencher, shape, false, None);
}

/// With the standard deviation of each value; the light by the amplitude, the noise of the distance known.
fn predicted(bencher: Bencher, shape: Shape, distance: DistanceStep) {
    let by_amplitude = AmplitudeNoise {
        read_variance_dn2: 4.0,
        shot_variance_dn2_per_dn: 0.5,
        ambient_variance_dn2_per_us: 0.0,
    };
    let choice = Choice {
        specular: Some(SpecularStep::None),
        distance: Some(distance),
        sigma: SigmaStep::Required,
        noise: Some(NoiseModel { by_amplitude, by_intensity: None }),
        ..Choice::default()
    };
    apply(bencher, shape, false, choice);
}

#[divan::bench(args = SHAPES)]
fn pointwise_with_sigma(bencher: Bencher, shape: Shape) {
    predicted(bencher, shape, DistanceStep::Eq5);
}

#[divan::bench(args = SHAPES)]
fn pointwise_spline_with_sigma(bencher: Bencher, shape: Shape) {
    predicted(bencher, shape, DistanceStep::Spline);
}

fn denoised(bencher: Bencher, shape: Shape, rule: DenoiseRule) {
    let denoise = Some(DenoiseStep::Smooth(rule));
    apply(bencher, shape, false, Choice { denoise, specular: Some(SpecularStep::None), ..Choice::default() });
}

#[divan::bench(args = SHAPES)]
fn denoised_by_median(bencher: Bencher, shape: Shape) {
    denoised(bencher, shape, DenoiseRule::Median);
}

#[divan::bench(args = SHAPES)]
fn denoised_by_wiener(bencher: Bencher, shape: Shape) {
    denoised(bencher, shape, DenoiseRule::Wiener);
}

#[divan::bench(args = SHAPES, sample_count = 5)]
fn denoised_by_plane(bencher: Bencher, shape: Shape) {
    denoised(bencher, shape, DenoiseRule::Plane);
}
