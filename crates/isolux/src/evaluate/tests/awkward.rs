//! Input that determines nothing, or next to nothing: a reason, never a panic, a NaN or a 0 in its place.

use super::*;

/// Refuses figures that are not finite, in whatever field: JSON writes them as null.
fn assert_finite(comparison: &Comparison) {
    for row in comparison.rows() {
        for figure in [row.before.ok(), row.after.ok(), row.before_valid_fraction, row.after_valid_fraction] {
            assert!(figure.is_none_or(f64::is_finite), "{}: {figure:?}", row.metric);
        }
    }
    for evaluation in [&comparison.before, &comparison.after] {
        let mut json = serde_json::to_value(evaluation).unwrap();
        let fields = json.as_object_mut().unwrap();
        fields.retain(|name, _| {
            !["valid_fraction", "reference_time_us", "pixel_cv_by_snr"].contains(&name.as_str())
        });
        let text = json.to_string();
        assert!(!text.contains("null"), "{text}");
    }
}

#[test]
fn nothing_that_is_pushed_leads_to_a_panic_or_a_figure_that_is_no_number() {
    let shapes = [(0, 0), (0, 4), (1, 1), (1, 2), (2, 1), (3, 3), (1, 40)];
    let values = [0.0, f32::NAN, f32::INFINITY, 1.0, f32::MAX, f32::from_bits(1)];
    let times = [
        IntegrationTime::Unknown,
        IntegrationTime::PerFrame(1000.0),
        IntegrationTime::PerFrame(f64::NAN),
        IntegrationTime::PerFrame(-1.0),
        IntegrationTime::PerFrame(f64::MAX),
    ];
    for shape in shapes.map(|(height, width)| Shape::new(height, width)) {
        for value in values {
            let frames: Vec<Frame> = times
                .iter()
                .flat_map(|time| {
                    let mut frame = frame(shape, 1.0, |_, _| value);
                    frame.integration_time_us = time.clone();
                    frame.distance_m = Some(Plane::filled(shape, value));
                    [frame.clone(), frame]
                })
                .collect();
            for count in 0..frames.len() {
                let mut run = Evaluator::new(shape, EvaluationSettings::default());
                run.set_reference(&EvaluationFrame::of_raw(&frames[count])).unwrap();
                for frame in &frames[..count] {
                    run.push(&EvaluationFrame::of_raw(frame)).unwrap();
                }
                assert_finite(&Comparison::new(&run, &run));
            }
        }
    }
}

#[test]
fn settings_that_make_no_sense_do_not_panic() {
    let shape = Shape::new(3, 3);
    let settings = EvaluationSettings {
        same_time_ratio: f64::NAN,
        slope_sample_pixels: 0,
        minimum_distance_ratio: f64::NAN,
        minimum_pair_distance_ratio: -1.0,
        snr_edges: vec![5.0, 1.0, f64::NAN],
    };
    let mut run = Evaluator::new(shape, settings);
    for time_us in [1.0, 2.0] {
        let mut frame = frame(shape, time_us, |row, column| (1 + row + column) as f32);
        frame.distance_m = Some(frame.amplitude.clone());
        run.push(&EvaluationFrame::of_raw(&frame)).unwrap();
    }
    assert_finite(&Comparison::new(&run, &run));
}

#[test]
fn the_reason_says_what_is_missing() {
    let shape = Shape::new(4, 4);
    let ramp = |row: usize, column: usize| (1 + row * 4 + column) as f32;
    let shot = |time_us: f64| frame(shape, time_us, ramp);
    let empty = Evaluator::new(shape, EvaluationSettings::default()).finish();
    assert_eq!(empty.pixel_cv, Err(Unavailable::NoFrames));
    assert_eq!(empty.valid_fraction, None);

    let black = evaluate(&[frame(shape, 1.0, |_, _| 0.0), frame(shape, 2.0, |_, _| 0.0)], Some(0));
    assert_eq!(black.pixel_cv, Err(Unavailable::NoValidPixels));
    assert_eq!(black.noise, Err(Unavailable::NoValidPixels));
    assert_eq!(black.valid_fraction, Some(0.0));

    let constant = evaluate(&[shot(10.0), shot(10.0)], Some(0));
    assert_eq!(constant.pixel_cv, Err(Unavailable::TimeConstant));
    assert_eq!(constant.threshold_iou, Err(Unavailable::TimeConstant));
    assert_eq!(constant.pixel_cv_by_snr, Err(Unavailable::TimeConstant));

    let mut unknown = shot(10.0);
    unknown.integration_time_us = IntegrationTime::Unknown;
    let unknown = evaluate(&[unknown.clone(), unknown], Some(0));
    assert_eq!(unknown.pixel_cv, Err(Unavailable::TimeUnknown));
    assert_eq!(unknown.histogram_distance, Err(Unavailable::TimeUnknown));

    let varied = evaluate(&[shot(10.0), shot(20.0)], None);
    assert!(varied.pixel_cv.is_ok());
    assert_eq!(varied.pixel_cv_by_snr, Err(Unavailable::NoRepeatedFrames));
    assert_eq!(varied.image_cv, Err(Unavailable::NoReference));
    assert_eq!(varied.distance_slope, Err(Unavailable::NoDistance));

    let flat = evaluate(&[frame(shape, 1.0, |_, _| 5.0), frame(shape, 2.0, |_, _| 5.0)], Some(0));
    assert_eq!(flat.threshold_iou, Err(Unavailable::NoThreshold));
    assert!(flat.histogram_distance.is_ok_and(|w1| w1.maximum_ln == 0.0));
}

#[test]
fn a_slope_needs_distances_that_differ_and_labels_where_there_is_a_target() {
    let shape = Shape::new(10, 10);
    let mut board = frame(shape, 10.0, |_, _| 7.0);
    board.distance_m = Some(Plane::from_fn(shape, |row, _| 1.0 + 0.01 * row as f32));
    let slope = |board: &Frame| evaluate(std::slice::from_ref(board), None).distance_slope;
    let Err(Unavailable::DistanceSpanTooSmall { found, minimum }) = slope(&board) else {
        panic!("{:?}", slope(&board))
    };
    assert_eq!(minimum, 1.2);
    assert_near(found, 1.09, 1e-6);
    board.target = Some(Plane::filled(shape, 0));
    assert_eq!(slope(&board), Err(Unavailable::NoLabelledPixels));
    board.distance_m = Some(Plane::filled(shape, f32::NAN));
    board.target = None;
    assert_eq!(slope(&board), Err(Unavailable::NoValidPixels));
}

#[test]
fn a_plane_of_another_shape_is_refused_and_does_not_count() {
    let mut run = Evaluator::new(Shape::new(2, 2), EvaluationSettings::default());
    let wrong = frame(Shape::new(2, 3), 1.0, |_, _| 1.0);
    assert!(run.push(&EvaluationFrame::of_raw(&wrong)).is_err());
    assert!(run.set_reference(&EvaluationFrame::of_raw(&wrong)).is_err());
    let mut right = frame(Shape::new(2, 2), 1.0, |_, _| 1.0);
    right.distance_m = Some(Plane::filled(Shape::new(3, 2), 1.0));
    let message = run.push(&EvaluationFrame::of_raw(&right)).unwrap_err().to_string();
    assert!(message.contains("`distance` is 3×2"), "{message}");
    assert_eq!(run.finish().frames, 0);
}
