//! The propagation against arithmetic by hand, numeric derivatives and simulated noise.

use crate::calibration::{Calibration, Reference};
use crate::denoise::DenoiseRule;
use crate::frame::phase::SPEED_OF_LIGHT_M_PER_S;
use crate::frame::{Channels, Frame, IntegrationTime, Plane, Shape};
use crate::numerics::hash::splitmix64;
use crate::standardize::{
    Choice, DenoiseStep, DistanceStep, PlanError, RecordingTraits, SigmaStep, SpecularStep, Standardizer,
    TimeStep,
};
use crate::terms::noise::{AmplitudeNoise, IntensityNoise, NoiseModel};

const CHANNELS: Channels = Channels::AMPLITUDE.union(Channels::DISTANCE).union(Channels::INTEGRATION_TIME);
/// At which c/(4πf) is 1 m.
const UNIT_FREQUENCY_HZ: f64 = SPEED_OF_LIGHT_M_PER_S / (4.0 * std::f64::consts::PI);

fn noise(read: f64, shot: f64, ambient: f64) -> NoiseModel {
    let by_amplitude = AmplitudeNoise {
        read_variance_dn2: read,
        shot_variance_dn2_per_dn: shot,
        ambient_variance_dn2_per_us: ambient,
    };
    NoiseModel { by_amplitude, by_intensity: None }
}

fn choice(noise: NoiseModel) -> Choice {
    Choice {
        time: Some(TimeStep::None),
        distance: Some(DistanceStep::Square),
        specular: Some(SpecularStep::None),
        sigma: SigmaStep::Required,
        noise: Some(noise),
        ..Choice::default()
    }
}

fn frame(amplitude: &[f32], distance_m: &[f32]) -> Frame {
    let shape = Shape::new(1, amplitude.len());
    let mut frame = Frame::new(shape);
    frame.amplitude.values_mut().copy_from_slice(amplitude);
    frame.distance_m = Some(Plane::from_vec(shape, distance_m.to_vec()).unwrap());
    frame.integration_time_us = IntegrationTime::PerFrame(2000.0);
    frame.flag_amplitude(None);
    frame
}

/// Values and σ at [`UNIT_FREQUENCY_HZ`].
fn apply(choice: &Choice, calibration: Option<&Calibration>, frame: &Frame) -> (Vec<f32>, Vec<f32>) {
    apply_at(Some(UNIT_FREQUENCY_HZ), choice, calibration, frame)
}

fn apply_at(
    modulation_frequency_hz: Option<f64>,
    choice: &Choice,
    calibration: Option<&Calibration>,
    frame: &Frame,
) -> (Vec<f32>, Vec<f32>) {
    let mut channels = CHANNELS;
    channels.set(Channels::INTENSITY, frame.intensity.is_some());
    let traits = RecordingTraits { modulation_frequency_hz, ..channels.into() };
    let mut stream = Standardizer::plan(choice, calibration, traits).unwrap().stream();
    let out = stream.push(frame).unwrap();
    (out.amplitude.values().to_vec(), out.sigma.as_ref().unwrap().values().to_vec())
}

/// Within `ulps` roundings of f32.
fn assert_near(found: f32, expected: f64, ulps: f64) {
    assert!(
        (f64::from(found) / expected - 1.0).abs() <= ulps * f64::from(f32::EPSILON),
        "{found} instead of {expected}"
    );
}

#[test]
fn one_pixel_by_hand() {
    // σ_a² = 4 + 0.5·100 + 0.001·2000 = 56, σ_d = 1 m · √56/100; s = d²/0.75² at 3 m.
    let (values, sigma) = apply(&choice(noise(4.0, 0.5, 0.001)), None, &frame(&[100.0], &[3.0]));
    let (relative, distance) = (56.0 / 1e4, 56.0 / 1e4);
    let (s, s1, s2) = (9.0 / 0.5625, 6.0 / 0.5625, 2.0 / 0.5625);
    let bias = 0.5 * s2 * distance;
    assert_near(values[0], 100.0 * (s - bias), 16.0);
    let port = s1 * s1 * distance + 0.5 * s2 * s2 * distance * distance;
    let variance = s * s * relative + (1.0 + relative) * port;
    assert_near(sigma[0], 100.0 * variance.sqrt(), 16.0);
}

#[test]
fn without_a_distance_step_the_amplitude_alone_counts() {
    let choice = Choice { distance: Some(DistanceStep::None), ..choice(noise(9.0, 0.0, 0.0)) };
    let (values, sigma) = apply(&choice, None, &frame(&[100.0, f32::NAN], &[3.0, 3.0]));
    assert_eq!((values[0], values[1].is_nan(), sigma[1].is_nan()), (100.0, true, true));
    assert_near(sigma[0], 3.0, 8.0);
}

#[test]
fn the_time_gain_scales_sigma_and_the_intensity_goes_before_the_amplitude() {
    let by_intensity = Some(IntensityNoise { read_variance_dn2: 1.0, shot_variance_dn2_per_dn: 0.1 });
    let model = NoiseModel { by_intensity, ..noise(4.0, 0.5, 0.0) };
    let choice = Choice { time: Some(TimeStep::Linear), distance: Some(DistanceStep::None), ..choice(model) };
    let mut frame = frame(&[100.0, 100.0], &[1.0, 1.0]);
    // 8200 / 2000 times √54.
    assert_near(apply(&choice, None, &frame).1[0], 4.1 * 54f64.sqrt(), 8.0);
    // A level below black is none.
    frame.intensity = Some(Plane::from_vec(frame.shape(), vec![240.0, -5.0]).unwrap());
    let (_, sigma) = apply(&choice, None, &frame);
    assert_near(sigma[0], 4.1 * 5.0, 8.0);
    assert_near(sigma[1], 4.1, 8.0);
}

#[test]
fn where_the_ambient_light_needs_an_unknown_time_sigma_is_unknown_and_the_value_stays() {
    let mut frame = frame(&[100.0, 100.0], &[3.0, 3.0]);
    let times = Plane::from_vec(frame.shape(), vec![2000.0, f32::NAN]).unwrap();
    frame.integration_time_us = IntegrationTime::PerPixel(times);
    let (values, sigma) = apply(&choice(noise(4.0, 0.5, 0.001)), None, &frame);
    assert!(sigma[0] > 0.0 && sigma[1].is_nan());
    assert_near(values[1], 1600.0, 4.0);
}

#[test]
fn a_hopeless_pixel_keeps_three_quarters_of_its_value() {
    let (values, _) = apply(&choice(noise(1e6, 0.0, 0.0)), None, &frame(&[100.0], &[0.75]));
    assert_near(values[0], 75.0, 8.0);
}

#[test]
fn what_is_not_known_is_refused_or_left_out() {
    let unknown = Choice { noise: None, ..choice(noise(1.0, 0.0, 0.0)) };
    let plan = |choice: &Choice| Standardizer::plan(choice, None, CHANNELS);
    assert_eq!(plan(&unknown).unwrap_err(), PlanError::NoiseUnknown);
    let where_known = Choice { sigma: SigmaStep::WhereKnown, ..unknown };
    assert!(!plan(&where_known).unwrap().predicts_sigma());
    let none = Choice { sigma: SigmaStep::None, ..choice(noise(1.0, 0.0, 0.0)) };
    assert!(!plan(&none).unwrap().predicts_sigma());
    assert!(plan(&choice(noise(-1.0, 2.0, 0.0))).is_err());
    let ambient = choice(noise(1.0, 0.0, 1.0));
    assert!(Standardizer::plan(&ambient, None, Channels::AMPLITUDE | Channels::DISTANCE).is_err());
}

/// A normal deviate: twelve uniforms.
fn normal(state: &mut u64) -> f64 {
    let mut uniform = || {
        *state += 1;
        (splitmix64(*state) >> 11) as f64 / (1u64 << 53) as f64
    };
    (0..12).map(|_| uniform()).sum::<f64>() - 6.0
}

/// A flat wall with noise in amplitude and distance; the law is the one of the calibration that `step` names.
fn wall(side: usize, distance_m: f64, amplitude: f64, sigma_dn: f64, unit_m: f64, state: &mut u64) -> Frame {
    let shape = Shape::new(side, side);
    let mut frame = Frame::new(shape);
    frame.amplitude = Plane::from_fn(shape, |_, _| (amplitude + sigma_dn * normal(state)) as f32);
    let sigma_m = unit_m * sigma_dn / amplitude;
    frame.distance_m = Some(Plane::from_fn(shape, |_, _| (distance_m + sigma_m * normal(state)) as f32));
    frame.integration_time_us = IntegrationTime::PerFrame(2000.0);
    frame.flag_amplitude(None);
    frame
}

/// Mean and deviation of a wall's values, and the root mean square of their σ.
fn statistics(
    frequency_hz: Option<f64>,
    choice: &Choice,
    calibration: Option<&Calibration>,
    frame: &Frame,
) -> (f64, f64, f64) {
    let (values, sigma) = apply_at(frequency_hz, choice, calibration, frame);
    let count = values.len() as f64;
    let mean = values.iter().map(|v| f64::from(*v)).sum::<f64>() / count;
    let variance = values.iter().map(|v| (f64::from(*v) - mean).powi(2)).sum::<f64>() / count;
    let predicted = sigma.iter().map(|s| f64::from(*s).powi(2)).sum::<f64>() / count;
    (mean, variance.sqrt(), predicted.sqrt())
}

#[test]
fn sigma_and_bias_are_those_of_simulated_noise_under_every_law() {
    let (amplitude, sigma_dn, unit_m, distance_m) = (200.0, 10.0, 2.0, 1.0);
    let frequency_hz = UNIT_FREQUENCY_HZ / unit_m;
    let calibration = calibration();
    for step in [DistanceStep::Square, DistanceStep::Eq5, DistanceStep::Cubic, DistanceStep::Spline] {
        let mut choice = choice(noise(sigma_dn * sigma_dn, 0.0, 0.0));
        choice.distance = Some(step);
        let noisy = wall(100, distance_m, amplitude, sigma_dn, unit_m, &mut 0);
        let (mean, found, predicted) = statistics(Some(frequency_hz), &choice, Some(&calibration), &noisy);
        choice.sigma = SigmaStep::None;
        let mut stream = Standardizer::plan(&choice, Some(&calibration), CHANNELS).unwrap().stream();
        let truth = stream.push(&frame(&[amplitude as f32], &[distance_m as f32])).unwrap();
        let truth = f64::from(truth.amplitude.values()[0]);
        // 10⁴ values: 1 % of the deviation for the mean, 0.7 % for the deviation; three of each. The fourth order of
        // the noise, (σ_d/d)⁴ ≈ 1e-4 of the value, is less than that.
        assert!((mean - truth).abs() < 0.03 * found, "{step:?}: {mean} {truth}");
        assert!((predicted / found - 1.0).abs() < 0.03, "{step:?}: {predicted} {found}");
    }
}

/// A calibration whose cubic and spline have a slope and a curvature of their own.
fn calibration() -> Calibration {
    use crate::terms::cubic::{Decay, DecayPoint};
    use crate::terms::{Cubic, Spline};
    let point = |i: u32| {
        let distance_m = 0.3 + 0.1 * f64::from(i);
        DecayPoint { distance_m, amplitude_dn: 1e4 / (distance_m.powi(2) + 0.3 * distance_m) }
    };
    let decay = [Decay { integration_time_us: None, points: (0..30).map(point).collect() }];
    let mut calibration = Calibration::new(None, Reference::default());
    calibration.terms.cubic = Some(Cubic::fit(&decay, 0.75).unwrap().0);
    calibration.terms.spline = Some(Spline::fit(&decay, 0.75, None).unwrap().0);
    calibration
}

#[test]
fn the_noise_of_the_distance_is_found_where_the_frequency_is_unknown() {
    let noisy = wall(100, 1.0, 200.0, 10.0, 2.0, &mut 9);
    let choice = choice(noise(100.0, 0.0, 0.0));
    let [(.., known), (.., unknown)] = [Some(UNIT_FREQUENCY_HZ / 2.0), None]
        .map(|frequency_hz| statistics(frequency_hz, &choice, None, &noisy));
    // The median of 10⁴ differences, each of which shares its pixels with eight others: 3 %.
    assert!((unknown / known - 1.0).abs() < 0.03, "{unknown} {known}");
}

#[test]
fn what_denoising_leaves_is_predicted_on_a_flat_wall() {
    // The distance's share of the noise is four times the amplitude's: what is left of it decides.
    let noisy = wall(120, 1.0, 200.0, 10.0, 2.0, &mut 77);
    for rule in [DenoiseRule::Median, DenoiseRule::Wiener, DenoiseRule::Plane] {
        let choice = Choice { denoise: Some(DenoiseStep::Smooth(rule)), ..choice(noise(100.0, 0.0, 0.0)) };
        let frequency_hz = Some(UNIT_FREQUENCY_HZ / 2.0);
        let (_, found, predicted) = statistics(frequency_hz, &choice, None, &noisy);
        // 0.6 % of the deviation by chance, four times that by the distances that 5×5 pixels share; the shares
        // themselves are good to a fifth of what is left, which is a third of the variance.
        assert!((predicted / found - 1.0).abs() < 0.06, "{rule:?}: {predicted} {found}");
    }
}
