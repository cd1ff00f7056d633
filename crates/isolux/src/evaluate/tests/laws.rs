//! Laws that hold for every recording.

use proptest::prelude::*;

use super::*;

const SHAPE: Shape = Shape::new(5, 6);
const PIXELS: usize = SHAPE.pixels();

/// Runs of one to three frames at one to four times; values 1..=4000 in whole steps, some pixels invalid.
fn recordings() -> impl Strategy<Value = Vec<Frame>> {
    let pixel = prop_oneof![9 => (1u16..=4000).prop_map(Some), 1 => Just(None)];
    let shot = prop::collection::vec(pixel, PIXELS);
    prop::collection::vec(prop::collection::vec(shot, 1..=3), 1..=4).prop_map(|runs| {
        let runs = runs.into_iter().enumerate();
        runs.flat_map(|(run, shots)| shots.into_iter().map(move |shot| recorded(run, &shot))).collect()
    })
}

fn recorded(run: usize, shot: &[Option<u16>]) -> Frame {
    let value = |row: usize, column: usize| shot[row * SHAPE.width + column].map_or(1e30, f32::from);
    let mut frame = frame(SHAPE, 500.0 * (1 << run) as f64, value);
    for (index, _) in shot.iter().enumerate().filter(|(_, value)| value.is_none()) {
        invalidate(&mut frame, index, 1e30);
    }
    let distance = |row, column| 0.5 + 0.1 * ((row * 7 + column * 5) % 11) as f32;
    frame.distance_m = Some(Plane::from_fn(SHAPE, distance));
    frame
}

/// Equal figures within `tolerance`, or the same reason.
fn same(first: Outcome<f64>, second: Outcome<f64>, tolerance: f64) -> Result<(), TestCaseError> {
    match (first, second) {
        (Ok(first), Ok(second)) => prop_assert!((first - second).abs() <= tolerance, "{first} {second}"),
        (first, second) => prop_assert_eq!(first, second),
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn a_gain_changes_nothing(frames in recordings(), gain in 1e-3..1e3f32) {
        let scaled = map(&frames, |_, _, value| value * gain);
        let (first, second) = (evaluate(&frames, Some(0)), evaluate(&scaled, Some(0)));
        // Each value is rounded once more to f32, 6e-8; slopes divide that by ln 1.05.
        let rounding = 1e-6;
        same(first.pixel_cv.map(|cv| cv.median), second.pixel_cv.map(|cv| cv.median), rounding)?;
        same(first.pixel_cv.map(|cv| cv.p95), second.pixel_cv.map(|cv| cv.p95), rounding)?;
        same(first.image_cv.map(|cv| cv.cv), second.image_cv.map(|cv| cv.cv), rounding)?;
        same(first.threshold_iou.map(|iou| iou.mean), second.threshold_iou.map(|iou| iou.mean), 0.0)?;
        same(
            first.histogram_distance.map(|w1| w1.mean_ln),
            second.histogram_distance.map(|w1| w1.mean_ln),
            rounding,
        )?;
        same(first.distance_slope.map(|fit| fit.slope), second.distance_slope.map(|fit| fit.slope), 1e-5)?;
        same(first.noise.map(|noise| noise.relative), second.noise.map(|noise| noise.relative), rounding)?;
    }

    #[test]
    fn a_power_of_distance_is_its_slope(power in -4.0..4.0f64, albedo in 0.1..1000.0f64) {
        let blank: Vec<Option<u16>> = vec![Some(1); PIXELS];
        let frames = map(&[recorded(0, &blank), recorded(2, &blank)], |frame, index, _| {
            let distance_m = frame.distance_m.as_ref().unwrap().values()[index];
            (albedo * f64::from(distance_m).powf(power)) as f32
        });
        let slope = evaluate(&frames, None).distance_slope.unwrap();
        // Two f32 roundings over ln 1.05.
        prop_assert!((slope.slope - power).abs() < 2.0 * 6e-8 / 0.048, "{}", slope.slope);
        prop_assert!(slope.low_95 <= slope.slope && slope.slope <= slope.high_95);
    }

    #[test]
    fn the_order_within_a_run_does_not_matter(frames in recordings()) {
        let mut turned = frames.clone();
        turned.chunk_by_mut(|a, b| a.integration_time_us == b.integration_time_us).for_each(<[Frame]>::reverse);
        // The same frame is the reference of both: the first of its run, then the last.
        let first_run = frames.chunk_by(|a, b| a.integration_time_us == b.integration_time_us).next().unwrap();
        let (first, second) = (evaluate(&frames, Some(0)), evaluate(&turned, Some(first_run.len() - 1)));
        same(first.pixel_cv.map(|cv| cv.median), second.pixel_cv.map(|cv| cv.median), 1e-12)?;
        same(first.pixel_cv.map(|cv| cv.p95), second.pixel_cv.map(|cv| cv.p95), 1e-12)?;
        same(first.image_cv.map(|cv| cv.cv), second.image_cv.map(|cv| cv.cv), 1e-12)?;
        same(first.threshold_iou.map(|iou| iou.mean), second.threshold_iou.map(|iou| iou.mean), 1e-12)?;
        same(
            first.histogram_distance.map(|w1| w1.maximum_ln),
            second.histogram_distance.map(|w1| w1.maximum_ln),
            1e-12,
        )?;
        prop_assert_eq!(first.valid_fraction, second.valid_fraction);
    }

    #[test]
    fn what_invalid_pixels_hold_does_not_matter(frames in recordings(), poison in prop::sample::select(
        vec![f32::NAN, 0.0, -5.0, 1.0, 1e30, f32::INFINITY, f32::MIN_POSITIVE],
    )) {
        let poisoned = map(&frames, |frame, index, value| if frame.is_valid(index) { value } else { poison });
        prop_assert_eq!(evaluate(&frames, Some(0)), evaluate(&poisoned, Some(0)));
    }

    #[test]
    fn evaluating_twice_gives_the_same_bits(frames in recordings()) {
        let json = |frames: &[Frame]| serde_json::to_string(&evaluate(frames, Some(0))).unwrap();
        prop_assert_eq!(json(&frames), json(&frames));
    }
}
