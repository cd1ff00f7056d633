//! What the evaluation finds where the truth is known.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "tests fail by panicking")]

mod common;

use common::standardize::standardize;
use common::time_us;
use isolux::evaluate::{Comparison, EvaluationFrame, EvaluationSettings, Evaluator, nearest_reference};
use isolux::standardize::{DistanceStep, SpecularStep, TimeStep};
use isolux::{Channels, Choice, Frame, PixelFlags, Standardizer};
use isolux_camera::{CameraModel, Scene, SimulatedFrame, Simulation};

const CHANNELS: Channels = Channels::AMPLITUDE.union(Channels::DISTANCE).union(Channels::INTEGRATION_TIME);

/// Without noise, saturation and warm-up the amplitude is t times a constant. Of each standardized value, the
/// amplitude, the multiplier and their product are each rounded by at most half an ulp: a standard deviation
/// cannot exceed the largest deviation, 3 · 2⁻²⁴.
#[test]
fn a_linear_scene_without_noise_has_no_variation_left() {
    let scene = Scene::builtin("office-desk").unwrap();
    let mut model = CameraModel::preset("sr3100").unwrap();
    model.warm_up_amplitude = 0.0;
    let simulation = Simulation::new(model, scene, 1).unwrap();
    let choice = Choice {
        time: Some(TimeStep::Linear),
        distance: Some(DistanceStep::None),
        specular: Some(SpecularStep::None),
        ..Choice::default()
    };
    let standardizer = Standardizer::plan(&choice, None, CHANNELS).unwrap();
    let mut simulated = SimulatedFrame::new(simulation.shape());
    let frames: Vec<Frame> = (0..simulation.len())
        .step_by(9)
        .map(|index| {
            simulation.render_frame(index, &mut simulated).unwrap();
            let mut frame = simulated.frame.clone();
            frame.amplitude = simulated.truth.linear_amplitude.clone();
            frame.flags.fill(PixelFlags::empty());
            frame.flag_amplitude(None);
            frame
        })
        .collect();
    let evaluator = || Evaluator::new(simulation.shape(), EvaluationSettings::default());
    let (mut before, mut after) = (evaluator(), evaluator());
    let reference = nearest_reference(frames.iter().map(|frame| Some(time_us(frame))), 8200.0).unwrap();
    let out = standardize(&standardizer, &frames[reference]);
    before.set_reference(&EvaluationFrame::of_raw(&frames[reference])).unwrap();
    let standardized = EvaluationFrame::of_standardized(&frames[reference], &out.amplitude, &out.flags);
    after.set_reference(&standardized).unwrap();
    for frame in &frames {
        let out = standardize(&standardizer, frame);
        before.push(&EvaluationFrame::of_raw(frame)).unwrap();
        after.push(&EvaluationFrame::of_standardized(frame, &out.amplitude, &out.flags)).unwrap();
    }
    let Comparison { before, after, .. } = Comparison::new(&before, &after);
    let rounding = 3.0 * 2f64.powi(-24);
    let (raw, left) = (before.pixel_cv.unwrap(), after.pixel_cv.unwrap());
    assert!(raw.median > 0.5, "{raw:?}");
    assert!(left.p95 <= rounding, "{left:?}");
    assert!(after.image_cv.unwrap().cv <= rounding, "{:?}", after.image_cv);
    assert!(after.histogram_distance.unwrap().maximum_ln < 1e-2, "{:?}", after.histogram_distance);
    // A pixel at the threshold itself may be rounded to either side: none of 25344 is expected to.
    assert!(after.threshold_iou.unwrap().minimum > 1.0 - 1e-3, "{:?}", after.threshold_iou);
    assert!(before.threshold_iou.unwrap().minimum < 0.5, "{:?}", before.threshold_iou);
}
