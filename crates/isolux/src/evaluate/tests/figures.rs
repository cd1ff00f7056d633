//! Recordings whose figures are known beforehand.

use super::*;

const SHAPE: Shape = Shape::new(40, 50);

/// Amplitude proportional to the time with relative noise `sigma`, `repeats` frames a time.
fn sweep(times_us: &[f64], repeats: usize, sigma: f64) -> Vec<Frame> {
    let mut normal = Normal(1);
    let times = times_us.iter().flat_map(|&time_us| std::iter::repeat_n(time_us, repeats));
    times
        .map(|time_us| {
            frame(SHAPE, time_us, |row, column| {
                let texture = if (row / 8 + column / 10) % 2 == 0 { 1.0 } else { 3.0 };
                (0.1 * time_us * texture * (1.0 + sigma * normal.next())) as f32
            })
        })
        .collect()
}

#[test]
fn temporal_noise_is_recovered_and_the_ramp_between_times_is_not_noise() {
    let noise = evaluate(&sweep(&[1000.0, 3000.0], 5, 0.02), None).noise.unwrap();
    assert_eq!((noise.method, noise.frames), (NoiseMethod::Temporal, 8));
    // The error of a deviation from the inner 95 % of normal values is 0.76 σ/√n (efficiency 87 %): n = 2000, eight
    // dependent pairs; five of those.
    assert_near(noise.relative, 0.02, 0.02 * 5.0 * 0.76 / 2000f64.sqrt());
}

/// A flat image near 20 DN in steps of 1 DN, with noise of 0.35 DN and a drift of `drift_dn` a frame.
fn quantized(frames: usize, drift_dn: f64) -> Vec<Frame> {
    let mut normal = Normal(7);
    let at = |number| {
        let level_dn = 20.0 + drift_dn * f64::from(number);
        frame(SHAPE, 1000.0, |_, _| (level_dn + 0.35 * normal.next()).round() as f32)
    };
    (0..u32::try_from(frames).unwrap()).map(at).collect()
}

/// Standard deviation over mean of all values of a frame.
fn relative_deviation(frame: &Frame) -> f64 {
    let mut moments = crate::numerics::statistics::Moments::default();
    frame.amplitude.values().iter().for_each(|value| moments.push(f64::from(*value)));
    moments.coefficient_of_variation().unwrap()
}

#[test]
fn noise_below_a_step_of_the_image_is_not_zero() {
    // At 20 DN, 15 % of the values are a step off: the median of their differences' deviations is 0. The number of
    // differences that are not has an error of √(0.27 · 0.73/2000)/0.27 = 3.7 % a pair, half of that in σ; five
    // of those. What the inner 95 % of steps instead of normal values are off by is 0.2 %.
    let frames = quantized(5, 0.0);
    let truth = relative_deviation(&frames[0]);
    assert_near(truth, 0.0196, 0.001);
    let noise = evaluate(&frames, None).noise.unwrap();
    assert_eq!((noise.method, noise.frames), (NoiseMethod::Temporal, 4));
    assert_near(noise.relative, truth, 0.1 * truth);

    // Half way between steps, where the median is a step or none, a drift of a fifth of a step: variance of the
    // rounded values at most 0.25 + the share of outer steps, σ 0.39 to 0.51 DN; no half step of drift added.
    let frames = quantized(3, 0.2);
    let truth = frames.iter().map(relative_deviation).sum::<f64>() / 3.0;
    assert_near(evaluate(&frames, None).noise.unwrap().relative, truth, 0.15 * truth);

    // A single frame: second differences; most of an even finer noise's are 0.
    let mut normal = Normal(9);
    let fine = frame(SHAPE, 1000.0, |_, _| (20.0 + 0.25 * normal.next()).round() as f32);
    let noise = evaluate(std::slice::from_ref(&fine), None).noise.unwrap();
    assert_eq!(noise.method, NoiseMethod::Spatial);
    assert!(noise.relative > 0.3 * relative_deviation(&fine), "{noise:?}");
}

#[test]
fn spatial_noise_serves_where_no_time_is_repeated() {
    let noise = evaluate(&sweep(&[1000.0, 3000.0], 1, 0.02), None).noise.unwrap();
    assert_eq!((noise.method, noise.frames), (NoiseMethod::Spatial, 2));
    // σ of a MAD estimate is 1.17 σ/√n (efficiency 37 %), five of those; the eight columns beside texture edges
    // (16 %) are outliers that raise a MAD by about 1.25 · 16 %.
    assert_near(noise.relative, 0.02, 0.02 * (0.25 + 0.13));
    assert!(noise.relative > 0.02);
}

/// Frames of one time whose texture moves by 7 columns from frame to frame.
#[test]
fn frames_of_other_views_are_not_noise_and_frames_of_noise_are() {
    let mut normal = Normal(3);
    let mut views = |sigma: f64, moves: usize, texture: f64| -> Vec<Frame> {
        let view = |number: usize| {
            frame(SHAPE, 1000.0, |row, column| {
                let place = (row / 8 + (column + moves * number) / 10) % 2;
                (100.0 * texture.powi(place as i32) * (1.0 + sigma * normal.next()).max(0.01)) as f32
            })
        };
        (0..5).map(view).collect()
    };
    let noise = evaluate(&views(0.02, 7, 5.0), None).noise.unwrap();
    assert_eq!(noise.method, NoiseMethod::Spatial);
    // As above; the texture is stronger.
    assert_near(noise.relative, 0.02, 0.02 * (0.25 + 0.13));
    // Nothing but noise: frames differ as much as pixels do.
    let noise = evaluate(&views(0.3, 0, 1.0), None).noise.unwrap();
    assert_eq!((noise.method, noise.frames), (NoiseMethod::Temporal, 4));
}

#[test]
fn noise_amplification_of_a_square_is_two_and_of_a_gain_one() {
    let before = sweep(&[1000.0, 3000.0], 4, 0.01);
    let compare = |after: &[Frame]| {
        Comparison::new(&evaluator(&before, Some(3)), &evaluator(after, Some(3))).noise_amplification.unwrap()
    };
    // ln A² = 2 ln A; f32 rounding of the values, 2⁻²⁴, against noise of 1 %.
    assert_near(compare(&map(&before, |_, _, value| value * value)), 2.0, 1e-4);
    assert_near(compare(&map(&before, |_, _, value| value * 3.0)), 1.0, 1e-4);
}

#[test]
fn noise_that_is_not_there_cannot_be_amplified() {
    let still = evaluator(&sweep(&[1000.0, 3000.0], 2, 0.0), Some(0));
    let comparison = Comparison::new(&still, &evaluator(&sweep(&[1000.0, 3000.0], 2, 0.1), Some(0)));
    assert_eq!(comparison.noise_amplification, Err(Unavailable::NoiseIsZero));
    let single = evaluator(&sweep(&[1000.0, 3000.0], 1, 0.1), Some(0));
    assert_eq!(Comparison::new(&still, &single).noise_amplification, Err(Unavailable::NoiseMethodsDiffer));
}

#[test]
fn a_perfect_standardization_scores_perfectly() {
    let before = sweep(&[1000.0, 2000.0, 8000.0], 2, 0.0);
    let after = map(&before, |frame, _, value| match frame.integration_time_us {
        IntegrationTime::PerFrame(time_us) => value / time_us as f32,
        _ => f32::NAN,
    });
    let comparison = Comparison::new(&evaluator(&before, Some(3)), &evaluator(&after, Some(3)));
    // Times 1 2 8: mean 11/3, population variance (1 + 4 + 64)/3 − 121/9 = 86/9.
    let expected = 86f64.sqrt() / 11.0;
    // One f32 rounding of the value before, two after.
    assert_near(comparison.before.pixel_cv.unwrap().median, expected, 1e-7);
    assert_near(comparison.before.image_cv.unwrap().cv, expected, 1e-7);
    assert_near(comparison.before.histogram_distance.unwrap().maximum_ln, 4f64.ln(), 1e-6);
    assert_near(comparison.before.otsu_shift.unwrap().maximum_ln, 4f64.ln(), 1e-6);
    // Otsu's threshold at 2000 µs lies at √(200·600) = 346; 1000 µs gives 100 and 300, all below it.
    assert_eq!(comparison.before.threshold_iou.unwrap().minimum, 0.0);
    let after = comparison.after;
    assert!(after.pixel_cv.unwrap().p95 < 2e-7);
    assert!(after.image_cv.unwrap().cv < 2e-7);
    assert!(after.histogram_distance.unwrap().maximum_ln < 4e-7);
    assert_eq!(after.threshold_iou.unwrap().minimum, 1.0);
}

#[test]
fn labels_keep_materials_apart() {
    let shape = Shape::new(20, 20);
    // Label 1 is dark and near, label 2 bright and far; label 0 is anything.
    let distance = |row: usize, _| if row < 10 { 1.0 + 0.05 * row as f32 } else { 0.2 * row as f32 };
    let mut boards = frame(shape, 1000.0, |row, column| {
        let albedo = if row < 10 { 1.0 } else { 30.0 };
        let unused = if column == 0 { 1e6 } else { 1.0 };
        unused * albedo * distance(row, column).powi(-2)
    });
    boards.distance_m = Some(Plane::from_fn(shape, distance));
    let without = evaluate(std::slice::from_ref(&boards), None).distance_slope.unwrap();
    assert!(!without.labelled && without.slope > -1.5, "{without:?}");
    let label = |row, column| if column == 0 { 0 } else { 1 + u8::from(row >= 10) };
    boards.target = Some(Plane::from_fn(shape, label));
    let with = evaluate(&[boards], None).distance_slope.unwrap();
    assert!(with.labelled);
    assert_eq!(with.valid_fraction, 0.95);
    // f32 roundings of d⁻² over pairs at least ln 1.05 apart.
    assert_near(with.slope, -2.0, 4.0 * 1.2e-7 / 0.048);
    assert!(with.low_95 <= with.slope && with.slope <= with.high_95);
}

#[test]
fn exposure_does_not_enter_the_slope() {
    // Near boards at long times, far boards at short ones, within 1:8 in time and 1:2 in distance.
    let shape = Shape::new(10, 10);
    let board = |time_us: f64| {
        let distance = |row: usize, _| (1.0 + 0.1 * row as f64 + 1.0 / time_us * 1000.0) as f32;
        let value = |row, column| (time_us * f64::from(distance(row, column)).powi(-2)) as f32;
        let mut board = frame(shape, time_us, value);
        board.distance_m = Some(Plane::from_fn(shape, distance));
        board
    };
    let slope = evaluate(&[1000.0, 2000.0, 8000.0].map(board), None).distance_slope.unwrap();
    assert_near(slope.slope, -2.0, 4.0 * 1.2e-7 / 0.048);
}

#[test]
fn pixels_fall_into_the_stratum_of_their_noise() {
    let shape = Shape::new(3, 40);
    let mut normal = Normal(7);
    let frames: Vec<Frame> = [1000.0, 2000.0]
        .iter()
        .flat_map(|&time_us| std::iter::repeat_n(time_us, 60))
        .map(|time_us| {
            frame(shape, time_us, |row, _| {
                // Noise so that the mean of 150 is 3, 7 and 30 σ.
                let sigma = 150.0 / [3.0, 7.0, 30.0][row];
                (time_us / 10.0 + sigma * normal.next()).max(0.001) as f32
            })
        })
        .collect();
    let strata = evaluate(&frames, Some(0)).pixel_cv_by_snr.unwrap();
    let members: Vec<usize> = strata.iter().map(|stratum| stratum.pixels).collect();
    // σ from 118 pairs is good to some 8 %: 7 is 5 σ from 5 and from 10.
    assert_eq!(members, [40, 40, 0, 40]);
    // Means 100 and 200: CV 1/3; the run means of the quiet pixels are good to 5/√60 = 0.65.
    assert_near(strata[3].median_cv.unwrap(), 1.0 / 3.0, 0.01);
    assert_eq!(strata[2].median_cv, None);
}

#[test]
fn pixels_with_times_of_their_own_are_compared_with_themselves() {
    let shape = Shape::new(4, 5);
    let shot = |number: usize| {
        // Row 0 always sees 125 µs, the others 125 and 5000 in turn.
        let time_us = move |row: usize, _| if row == 0 || number.is_multiple_of(2) { 125.0 } else { 5000.0 };
        let mut shot = frame(shape, 1.0, |row, column| 2.0 * time_us(row, column));
        shot.integration_time_us = IntegrationTime::PerPixel(Plane::from_fn(shape, time_us));
        shot
    };
    let found = evaluate(&[0, 1, 2, 3].map(shot), Some(0));
    let cv = found.pixel_cv.unwrap();
    assert_eq!((cv.pixels, cv.valid_fraction), (15, 0.75));
    assert_near(cv.median, 4875.0 / 5125.0, 1e-12);
    for reason in [found.image_cv.err(), found.threshold_iou.err(), found.histogram_distance.err()] {
        assert_eq!(reason, Some(Unavailable::TimePerPixel));
    }
}

#[test]
fn rows_list_every_figure_with_its_valid_fraction() {
    let before = sweep(&[1000.0, 2000.0, 8000.0], 5, 0.05);
    let comparison = Comparison::new(&evaluator(&before, Some(9)), &evaluator(&before, Some(9)));
    let rows = comparison.rows();
    assert_eq!(rows.len(), 22);
    for row in &rows {
        assert_eq!(row.before, row.after, "{}", row.metric);
        assert_eq!(row.before.is_ok(), row.before_valid_fraction.is_some(), "{}", row.metric);
    }
    let find = |name: &str| rows.iter().find(|row| row.metric.starts_with(name)).unwrap();
    assert_eq!(find("noise amplification").after, Ok(1.0));
    assert_eq!(find("slope").before, Err(Unavailable::NoDistance));
    let json = serde_json::to_value(&comparison).unwrap();
    assert_eq!(json["before"]["distance_slope"]["unavailable"], "no_distance");
    assert!(json["after"]["pixel_cv"]["median"].as_f64().unwrap() > 0.5);
}
