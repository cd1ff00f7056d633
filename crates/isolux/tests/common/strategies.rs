//! Random frames, chains and calibrations.

use isolux::specular::{HistogramRule, KneeRule, PercentRule, SigmaRule};
use isolux::standardize::{DistanceStep, SpecularStep, TimeStep};
use isolux::terms::cubic::{Decay, DecayPoint};
use isolux::terms::lut::ExposureSample;
use isolux::terms::noise::{AmplitudeNoise, IntensityNoise, Noise};
use isolux::terms::response::{
    AmbientNoise, AmbientResponse, FullWell, PhaseSampleResponse, PixelResponse, Response,
};
use isolux::terms::spline::{Harmonic, Law};
use isolux::terms::{Cubic, FitQuality, Lut, Source, Spline};
use isolux::{
    Calibration, Channels, Choice, Frame, IntegrationTime, PixelFlags, Plane, Reference, Shape, SpecularRule,
    Standardizer,
};
use proptest::prelude::*;

pub const SHAPE: Shape = Shape::new(9, 13);
pub const PIXELS: usize = SHAPE.pixels();
pub const CHANNELS: Channels =
    Channels::AMPLITUDE.union(Channels::DISTANCE).union(Channels::INTEGRATION_TIME);

/// That many cases, and no files of failed ones: a failure prints its smallest input.
pub fn cases(cases: u32) -> ProptestConfig {
    ProptestConfig { cases, failure_persistence: None, ..ProptestConfig::default() }
}

/// A table for 200 to 20000 µs, a cubic and a spline for 0.3 to 3 m.
pub fn calibration() -> Calibration {
    let sample = |&t: &f64| ExposureSample {
        integration_time_us: t,
        mean_amplitude_dn: t * (-t / 30_000.0).exp(),
        frame_spread: 0.0,
    };
    let times = [200.0, 700.0, 3000.0, 8200.0, 13_000.0, 20_000.0];
    let point = |i: u32| 0.3 + 0.27 * f64::from(i);
    let points =
        (0..11).map(point).map(|d| DecayPoint { distance_m: d, amplitude_dn: 500.0 / (d * d + 0.02) });
    let decay = Decay { integration_time_us: None, points: points.collect() };
    let mut calibration = Calibration::new(None, Reference::default());
    calibration.terms.lut = Some(Lut::fit(&times.iter().map(sample).collect::<Vec<_>>(), 8200.0).unwrap());
    calibration.terms.spline = Some(Spline::fit(std::slice::from_ref(&decay), 0.75, Some(20e6)).unwrap().0);
    calibration.terms.cubic = Some(Cubic::fit(&[decay], 0.75).unwrap().0);
    calibration
}

pub fn steps(time: TimeStep, distance: DistanceStep, specular: SpecularStep) -> Standardizer {
    let (time, distance, specular) = (Some(time), Some(distance), Some(specular));
    let choice = Choice { time, distance, specular, ..Choice::default() };
    Standardizer::plan(&choice, Some(&calibration()), CHANNELS).unwrap()
}

pub fn time_steps() -> impl Strategy<Value = TimeStep> {
    prop::sample::select(vec![TimeStep::Lut, TimeStep::Linear, TimeStep::None])
}

pub fn distance_steps() -> impl Strategy<Value = DistanceStep> {
    prop::sample::select(vec![
        DistanceStep::Cubic,
        DistanceStep::Spline,
        DistanceStep::Square,
        DistanceStep::Eq5,
        DistanceStep::None,
    ])
}

pub fn specular_steps() -> impl Strategy<Value = SpecularStep> {
    prop::sample::select(vec![
        SpecularStep::None,
        SpecularStep::Limit(SpecularRule::Histogram(HistogramRule::default())),
        SpecularStep::Limit(SpecularRule::Sigma(SigmaRule::default())),
        SpecularStep::Limit(SpecularRule::Percent(PercentRule::default())),
        SpecularStep::Limit(SpecularRule::Percent(PercentRule::Quantile(0.9))),
        SpecularStep::Limit(SpecularRule::Knee(KneeRule::default())),
    ])
}

/// Amplitudes and distances as a camera may deliver them, some of them no measurement.
pub fn frames() -> impl Strategy<Value = Frame> {
    let odd = || prop::sample::select(vec![f32::NAN, 0.0, -1.0, f32::INFINITY]);
    let amplitudes = prop::collection::vec(prop_oneof![9 => 0.1f32..1e4, 1 => odd()], PIXELS);
    let distances = prop::collection::vec(prop_oneof![9 => 0.1f32..9.0, 1 => odd()], PIXELS);
    let per_frame = (50.0..30_000.0f64).prop_map(IntegrationTime::PerFrame);
    let time = prop_oneof![8 => 50.0f32..30_000.0, 1 => Just(f32::NAN), 1 => Just(0.0)];
    let per_pixel = prop::collection::vec(time, PIXELS)
        .prop_map(|times| IntegrationTime::PerPixel(Plane::from_vec(SHAPE, times).unwrap()));
    let flags = prop::collection::vec(prop_oneof![9 => Just(0u16), 1 => 0u16..64], PIXELS);
    (amplitudes, distances, prop_oneof![per_frame, per_pixel], flags).prop_map(
        |(amplitudes, distances, time, flags)| {
            let mut frame = Frame::new(SHAPE);
            frame.amplitude = Plane::from_vec(SHAPE, amplitudes).unwrap();
            frame.distance_m = Some(Plane::from_vec(SHAPE, distances).unwrap());
            frame.integration_time_us = time;
            frame.flags.values_mut().iter_mut().zip(flags).for_each(|(flag, bits)| {
                *flag = PixelFlags::from_bits_retain(bits);
            });
            frame.flag_amplitude(None);
            frame
        },
    )
}

pub fn words() -> impl Strategy<Value = Vec<String>> {
    prop::collection::vec(".{0,12}", 0..3)
}

fn quality() -> impl Strategy<Value = FitQuality> {
    (1usize..99, 0.0..1.0f64, prop::option::of(0.0..1.0f64))
        .prop_map(|(points, residual, held_out_residual)| FitQuality { points, residual, held_out_residual })
}

fn sources() -> impl Strategy<Value = Vec<Source>> {
    let source =
        (".{0,12}", 0usize..999, 0usize..999).prop_map(|(recording, frames_used, frames_left_out)| Source {
            recording,
            frames_used,
            frames_left_out,
        });
    prop::collection::vec(source, 0..3)
}

pub fn luts() -> impl Strategy<Value = Lut> {
    let table = prop::collection::vec((1e-3..1e4f64, 1e-4..1e4f64), 2..9);
    (table, sources(), quality(), words()).prop_map(|(table, fitted_on, fit, warnings)| {
        let mut time = 0.0;
        let integration_time_us: Vec<f64> = table
            .iter()
            .map(|(step, _)| {
                time += step;
                time
            })
            .collect();
        Lut {
            version: Lut::VERSION,
            multiplier: table.iter().map(|(_, multiplier)| *multiplier).collect(),
            valid_integration_time_us: [integration_time_us[0], time],
            integration_time_us,
            fitted_on,
            fit,
            warnings,
        }
    })
}

fn wells() -> impl Strategy<Value = FullWell> {
    (1.0..1e5f64, 1.0..16.0f64, -1.0..1.0f64).prop_map(|(full_well_dn, softness, black)| FullWell {
        full_well_dn,
        softness,
        black_level_dn: black * full_well_dn,
    })
}

fn ambient_responses() -> impl Strategy<Value = AmbientResponse> {
    let noise = (0.0..1e3f64, 1e-6..1e3f64).prop_map(|(read_variance_dn2, shot_variance_dn2_per_dn)| {
        AmbientNoise { read_variance_dn2, shot_variance_dn2_per_dn }
    });
    let light = (1.0..10.0f64, 0.0..1e3f64, 1e-3..1e3f64, prop::option::of(noise));
    let well = (1.0..1e5f64, 1.0..16.0f64, 0.5..1.0f64);
    (well, light, splines(), prop::option::of(1e6..1e8f64)).prop_map(
        |((full_well_dn, softness, clip), (own_charge, ambient, target, noise), spline, frequency_hz)| {
            AmbientResponse {
                full_well_dn,
                softness,
                clip,
                own_charge,
                ambient_dn_per_us: ambient,
                target_dn_per_us: target,
                law: spline.law,
                modulation_frequency_hz: frequency_hz,
                noise,
                fitted_on: spline.fitted_on,
                fit: spline.fit,
            }
        },
    )
}

/// Three tiers of different kinds, one of them a map of 2×3 pixels.
pub fn responses() -> impl Strategy<Value = Response> {
    let map = prop::collection::vec(prop::option::of(1e-2..1e6f32), 6);
    let pixel = (map, 1.0..16.0f64, 0.1..1.0f64, sources(), quality()).prop_map(
        |(map, softness, largest_fill, fitted_on, fit)| PixelResponse {
            softness,
            largest_fill,
            valid_integration_time_us: [10.0, 20.0],
            full_well_time_us: map.chunks(3).map(<[_]>::to_vec).collect(),
            fitted_on,
            fit,
        },
    );
    let bins = (wells(), prop::option::of(1e6..1e8f64), 0.01..0.5f64, sources(), quality()).prop_map(
        |(well, modulation_frequency_hz, share, fitted_on, fit)| PhaseSampleResponse {
            largest_dn: well.black_level_dn + share * well.full_well_dn,
            clip_dn: modulation_frequency_hz.map(|_| 2.0 * well.full_well_dn),
            well,
            modulation_frequency_hz,
            fitted_on,
            fit,
        },
    );
    let tiers = (prop::option::of(pixel), prop::option::of(ambient_responses()), prop::option::of(bins));
    (tiers, words()).prop_map(|((pixel, ambient, phase_samples), warnings)| Response {
        version: Response::VERSION,
        scalar: None,
        amplitude: None,
        pixel,
        ambient,
        intensity: None,
        phase_samples,
        warnings,
    })
}

pub fn cubics() -> impl Strategy<Value = Cubic> {
    let numbers = (prop::array::uniform4(1e-6..1e3f64), 1e-3..1e2f64, 1e-3..1e2f64);
    (numbers, sources(), quality(), words()).prop_map(
        |((coefficients, min, span), fitted_on, fit, warnings)| {
            let valid_distance_m = [min, min + span];
            Cubic { version: Cubic::VERSION, coefficients, valid_distance_m, fitted_on, fit, warnings }
        },
    )
}

pub fn splines() -> impl Strategy<Value = Spline> {
    let harmonic =
        (1e6..1e8f64, -0.4..0.4f64, -0.4..0.4f64).prop_map(|(modulation_frequency_hz, cosine, sine)| {
            Harmonic { modulation_frequency_hz, cosine, sine }
        });
    let numbers = (prop::collection::vec(-2.0..2.0f64, 4..40), prop::option::of(harmonic));
    let range = (1e-2..1.0f64, 0.0..1.0f64, 0.1..10.0f64);
    (numbers, range, 0.0..1.0f64, sources(), quality(), words()).prop_map(
        |((coefficients, harmonic), (min, at, span), curvature_weight, fitted_on, fit, warnings)| Spline {
            version: Spline::VERSION,
            law: Law {
                reference_distance_m: min + at * span,
                valid_distance_m: [min, min + span],
                coefficients,
                harmonic,
                curvature_weight,
            },
            fitted_on,
            fit,
            warnings,
        },
    )
}

/// The values of a plane as they are stored, NaN included.
pub fn bits(plane: &Plane<f32>) -> Vec<u32> {
    plane.values().iter().map(|value| value.to_bits()).collect()
}

pub fn noises() -> impl Strategy<Value = Noise> {
    let by_amplitude =
        (1e-3..1e3f64, 0.0..10.0f64, 0.0..1.0f64).prop_map(|(read, shot, ambient)| AmplitudeNoise {
            read_variance_dn2: read,
            shot_variance_dn2_per_dn: shot,
            ambient_variance_dn2_per_us: ambient,
        });
    let by_intensity = (1e-3..1e3f64, 0.0..10.0f64)
        .prop_map(|(read, shot)| IntensityNoise { read_variance_dn2: read, shot_variance_dn2_per_dn: shot });
    (by_amplitude, prop::option::of(by_intensity), 0.0..1.0f64).prop_map(
        |(by_amplitude, by_intensity, residual)| Noise {
            version: Noise::VERSION,
            by_amplitude,
            by_intensity,
            fitted_on: Vec::new(),
            fit: FitQuality { points: 9, residual, held_out_residual: None },
        },
    )
}
