//! Known truths (methods, section 4): what each kind of recording determines, and how well.

use super::*;
use crate::frame::Shape;
use crate::terms::profile::Places;

pub(super) const NOISE: f64 = 0.02;
const FREQUENCY_HZ: f64 = 20e6;
const SHAPE: Shape = Shape::new(144, 176);

/// Uniform numbers 0..1 (Knuth's MMIX generator), and nearly normal ones.
pub(super) struct Random(pub(super) u64);

impl Random {
    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    pub(super) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.uniform()
    }

    pub(super) fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.uniform()).sum::<f64>() - 6.0
    }

    /// 2 % of noise, and 5 % of observations that are wrong by up to a factor of three.
    fn error(&mut self) -> f64 {
        let outlier = if self.uniform() < 0.05 { self.between(-1.0, 1.0) } else { 0.0 };
        NOISE * self.normal() + outlier
    }
}

pub(super) fn places() -> Places {
    Places::new(SHAPE, None)
}

/// Tangent of the angle off the axis, at one half diagonal: 29°.
const TANGENT: f64 = 0.55;

pub(super) fn ln_profile([x, y]: [f64; 2]) -> f64 {
    -2.5 * (TANGENT * TANGENT * (x * x + y * y)).ln_1p() + 0.05 * x + 0.03 * x * y * y
}

pub(super) fn ln_law(d: f64) -> f64 {
    let beside = |d: f64| {
        -2.0 * (0.0025 / (d * d)).ln_1p()
            + 0.015 * (16.0 * std::f64::consts::PI * FREQUENCY_HZ * d / 299_792_458.0).cos()
    };
    -2.0 * (d / 0.75).ln() + beside(d) - beside(0.75)
}

fn ln_time(j: usize) -> f64 {
    let t = 2f64.powi(j as i32);
    t.ln() - 0.01 * t
}

pub(super) const EXPONENT: f64 = 1.3;

/// What a surface of reflectivity `albedo` gives; `time` indexes [`ln_time`].
pub(super) fn observe(
    random: &mut Random,
    surface: u32,
    albedo: f64,
    time: u16,
    [d, cosine]: [f64; 2],
    place: [f64; 2],
) -> Observation {
    let truth =
        albedo.ln() + ln_time(usize::from(time)) + ln_law(d) + ln_profile(place) + EXPONENT * cosine.ln();
    Observation {
        surface,
        // The errors are independent, whatever frames they are divided into.
        frame: (random.0 >> 40) as u32 % 64,
        time,
        ln_amplitude: (truth + random.error()) as f32,
        distance_m: d as f32,
        place: place.map(|v| v as f32),
        cosine: cosine as f32,
        weight: 1.0,
    }
}

pub(super) fn everything() -> JointModel {
    JointModel {
        time: Some(TimeModel { count: 6, reference: 2, of_frames: false }),
        distance: Some(DistanceModel { reference_m: 0.75, modulation_frequency_hz: Some(FREQUENCY_HZ) }),
        profile: Some(places()),
        angle: AngleModel::Free,
        smoothness: 1.0,
    }
}

fn anywhere(random: &mut Random) -> [f64; 2] {
    [random.between(-0.77, 0.77), random.between(-0.63, 0.63)]
}

fn refused(fit: &JointFit) -> Vec<Factor> {
    fit.findings.iter().filter(|finding| finding.refusal.is_some()).map(|finding| finding.factor).collect()
}

/// Largest error of ln v in the cells that were seen, each in its own standard errors.
fn profile_deviation(fit: &JointFit) -> f64 {
    let profile = fit.profile.as_ref().unwrap();
    let deviation = |(cell, error): (usize, &Option<f64>)| {
        let place = places().cell_centre(cell);
        error.map(|error| ((profile.map.ln_gain(place) - ln_profile(place)) / error).abs())
    };
    profile.cell_errors.iter().enumerate().filter_map(deviation).fold(0.0, f64::max)
}

/// Largest error of ln v in the cells that were seen, of ln h over its distances, of s.
fn errors(fit: &JointFit) -> [f64; 3] {
    let largest =
        |errors: &mut dyn Iterator<Item = f64>| errors.fold(0.0, |worst: f64, e| worst.max(e.abs()));
    let profile = fit.profile.as_ref().map_or(f64::NAN, |profile| {
        let seen = (0..profile.cell_errors.len()).filter(|&cell| profile.cell_errors[cell].is_some());
        largest(
            &mut seen.map(|cell| places().cell_centre(cell)).map(|p| profile.map.ln_gain(p) - ln_profile(p)),
        )
    });
    let distance = fit.distance.as_ref().map_or(f64::NAN, |law| {
        let [min_m, max_m] = law.valid_distance_m;
        largest(
            &mut (0..=100)
                .map(|i| min_m * (max_m / min_m).powf(f64::from(i) / 100.0))
                .map(|d| law.ln_response(d) - ln_law(d)),
        )
    });
    let time = fit.ln_time.as_ref().map_or(f64::NAN, |times| {
        largest(&mut times.iter().enumerate().map(|(j, s)| s - (ln_time(j) - ln_time(2))))
    });
    [profile, distance, time]
}

/// Predicted standard error of a factor.
fn predicted(fit: &JointFit, factor: Factor) -> f64 {
    fit.findings.iter().find(|finding| finding.factor == factor).unwrap().standard_error
}

#[test]
fn a_still_scene_of_unknown_reflectivities_determines_the_times_alone() {
    let mut random = Random(1);
    let mut observations = Vec::new();
    for surface in 0..800 {
        let (albedo, d) = (random.between(0.1, 0.9), random.between(0.6, 3.0));
        let (cosine, place) = (random.between(0.4, 1.0), anywhere(&mut random));
        observations
            .extend((0..6).map(|time| observe(&mut random, surface, albedo, time, [d, cosine], place)));
    }
    let fit = solve(&observations, &everything()).unwrap();
    assert_eq!(refused(&fit), [Factor::Distance, Factor::Profile, Factor::Angle]);
    assert!(fit.findings.iter().skip(1).all(|f| matches!(f.refusal, Some(Refusal::NotSeen { .. }))));
    assert!(fit.distance.is_none() && fit.profile.is_none() && fit.angle_exponent.is_none());
    // Six times less their gauge, which the levels take up.
    assert_eq!(fit.rank, 5);
    // A difference of means of 800 observations, each with a share in its surface's level: 2 % √(2/800), and five
    // standard errors for the worst of five.
    assert!(errors(&fit)[2] < 5.0 * NOISE * (2.0f64 / 800.0).sqrt(), "{:?}", errors(&fit));
    assert!((fit.sigma / NOISE - 1.0).abs() < 0.1, "{}", fit.sigma);
}

#[test]
fn a_rotation_about_the_camera_determines_the_profile_alone() {
    let mut random = Random(2);
    let mut observations = Vec::new();
    for surface in 0..1500 {
        let (albedo, d, cosine) =
            (random.between(0.1, 0.9), random.between(0.6, 3.0), random.between(0.4, 1.0));
        for _ in 0..8 {
            let place = anywhere(&mut random);
            // Half a percent of noise in the distance, as a camera has it, must not pass for a change of it.
            let measured = d * (1.0 + 0.005 * random.normal());
            let mut seen = observe(&mut random, surface, albedo, 0, [d, cosine], place);
            seen.distance_m = measured as f32;
            observations.push(seen);
        }
    }
    let model = JointModel { time: None, ..everything() };
    let fit = solve(&observations, &model).unwrap();
    assert_eq!(refused(&fit), [Factor::Distance, Factor::Angle]);
    // 12000 observations, 1500 levels and some fifty unknowns: the tensor's cells hold 60 each.
    let (error, predicted) = (errors(&fit)[0], predicted(&fit, Factor::Profile));
    assert!(
        predicted < NOISE * (50.0f64 / 10_000.0).sqrt() * 1.5 && error < 5.0 * predicted,
        "{error} {predicted}"
    );
}

/// A white wall that faces the camera, at fourteen depths.
fn wall(random: &mut Random) -> Vec<Observation> {
    let mut observations = Vec::new();
    for step in 0..14 {
        let depth = 0.65 * 1.12f64.powi(step);
        for _ in 0..500 {
            let place = anywhere(random);
            let cosine = (1.0 + TANGENT * TANGENT * (place[0].powi(2) + place[1].powi(2))).sqrt().recip();
            observations.push(observe(random, 7, 0.8, 0, [depth / cosine, cosine], place));
        }
    }
    observations
}

#[test]
fn a_wall_that_faces_the_camera_confounds_profile_and_angle() {
    let observations = wall(&mut Random(3));
    let model = JointModel { time: None, ..everything() };
    let fit = solve(&observations, &model).unwrap();
    assert_eq!(refused(&fit), [Factor::Profile, Factor::Angle], "{:?}", fit.findings);
    let words = fit.refusal(Factor::Profile).unwrap().to_string();
    assert!(words.contains("angle exponent") && words.contains("faced the camera in all frames"), "{words}");
    // With the exponent known, the wall's geometry tells the profile.
    let known = JointModel { angle: AngleModel::Fixed(EXPONENT), ..model };
    let fit = solve(&observations, &known).unwrap();
    assert!(fit.is_determined(), "{:?}", fit.findings);
    assert!(profile_deviation(&fit) < 5.0, "{}", profile_deviation(&fit));
    // At the ends, where the wall's middle alone is seen and a curve has neighbours on one side only, the error is
    // some three times the average.
    assert!(errors(&fit)[1] < 10.0 * predicted(&fit, Factor::Distance), "{:?}", errors(&fit));
}

/// Surfaces seen from many poses and at several times.
fn wandering(random: &mut Random, surfaces: u32, views: u32) -> Vec<Observation> {
    let mut observations = Vec::new();
    for surface in 0..surfaces {
        let albedo = random.between(0.1, 0.9);
        for view in 0..views {
            let geometry = [random.between(0.6, 3.0), random.between(0.4, 1.0)];
            let place = anywhere(random);
            observations.push(observe(random, surface, albedo, (view % 6) as u16, geometry, place));
        }
    }
    observations
}

#[test]
fn rotation_and_translation_determine_everything() {
    let fit = solve(&wandering(&mut Random(4), 600, 20), &everything()).unwrap();
    assert!(fit.is_determined(), "{:?}", fit.findings);
    let [_, distance, time] = errors(&fit);
    // Five predicted standard errors for the worst of some two hundred places, which the predictions must deserve.
    assert!(profile_deviation(&fit) < 5.0, "{}", profile_deviation(&fit));
    for (error, factor) in [(distance, Factor::Distance), (time, Factor::Time)] {
        let predicted = predicted(&fit, factor);
        assert!(error < 5.0 * predicted && predicted < 0.25 * NOISE, "{factor:?}: {error} {predicted}");
    }
    let k = fit.angle_exponent.unwrap();
    let error = predicted(&fit, Factor::Angle) / 2f64.ln();
    assert!((k - EXPONENT).abs() < 5.0 * error, "{k} {error}");
    assert!((fit.sigma / NOISE - 1.0).abs() < 0.1, "{}", fit.sigma);
    // 5 % outliers: most of them lie beyond the cutoff, none of the rest does.
    let rejected = fit.weights.iter().filter(|weight| **weight == 0.0).count() as f64 / 12_000.0;
    assert!((0.03..0.055).contains(&rejected), "{rejected}");
}

#[test]
fn errors_of_the_fit_are_as_large_as_predicted() {
    // Chi squared of k over 24 runs: the mean of z² is 1 with a standard deviation of √(2/24) = 0.29.
    let square = |seed: u64| {
        let fit = solve(&wandering(&mut Random(seed), 60, 20), &everything()).unwrap();
        let error = predicted(&fit, Factor::Angle) / 2f64.ln();
        ((fit.angle_exponent.unwrap() - EXPONENT) / error).powi(2)
    };
    let mean = (100..124).map(square).sum::<f64>() / 24.0;
    // Tukey's biweight, 5 % of outliers and degrees of freedom add a quarter at most; four deviations below and above.
    assert!((0.2..2.4).contains(&mean), "{mean}");
}

#[test]
fn what_cannot_be_fitted_is_an_error_with_numbers() {
    let nothing =
        JointModel { time: None, distance: None, profile: None, angle: AngleModel::Absent, smoothness: 1.0 };
    let observations = wall(&mut Random(5));
    assert!(matches!(solve(&observations, &nothing), Err(JointError::Model { .. })));
    let time = Some(TimeModel { count: 3, reference: 3, of_frames: false });
    assert!(matches!(solve(&observations, &JointModel { time, ..nothing }), Err(JointError::Model { .. })));
    let rough = JointModel { smoothness: 0.0, ..everything() };
    assert!(matches!(solve(&observations, &rough), Err(JointError::Model { .. })));
    assert!(matches!(solve(&[], &everything()), Err(JointError::TooFew { found: 0, .. })));
    let alone: Vec<Observation> =
        (0u32..).zip(&observations).map(|(surface, o)| Observation { surface, ..*o }).collect();
    assert!(matches!(solve(&alone, &everything()), Err(JointError::TooFew { found: 0, .. })));
    // Values without a logarithm are left out, wherever they are.
    let mut spoilt = observations.clone();
    spoilt[3].ln_amplitude = f32::NEG_INFINITY;
    spoilt[4].distance_m = 0.0;
    spoilt[5].cosine = -0.3;
    spoilt[6].place[1] = f32::NAN;
    spoilt[7].weight = f32::NAN;
    spoilt[8].weight = 0.0;
    spoilt[8].ln_amplitude = 100.0;
    let model = JointModel { time: None, angle: AngleModel::Fixed(1.0), ..everything() };
    let fit = solve(&spoilt, &model).unwrap();
    assert!((0..10).all(|i| fit.residuals[i].is_nan() == (3..8).contains(&i)));
    assert_eq!(fit.residuals.len(), spoilt.len());
    // What has no weight is predicted and does not pull.
    assert!(fit.residuals[8] > 90.0 && fit.weights[8] == 0.0 && fit.sigma < 1.1 * NOISE, "{}", fit.sigma);
}

#[test]
fn one_distance_one_place_and_one_time_determine_nothing() {
    let mut random = Random(6);
    let observations: Vec<Observation> =
        (0..400).map(|_| observe(&mut random, 0, 0.5, 2, [1.0, 0.9], [0.1, 0.1])).collect();
    let fit = solve(&observations, &everything()).unwrap();
    assert_eq!(refused(&fit).len(), 4);
    assert!(
        fit.findings.iter().all(|f| matches!(f.refusal, Some(Refusal::NotSeen { .. }))),
        "{:?}",
        fit.findings
    );
}
