//! The evaluator as a whole; each metric's own tests stand beside it.

mod awkward;
mod figures;
mod laws;
mod numpy;

use crate::frame::{Frame, IntegrationTime, PixelFlags, Plane, Shape};

use super::*;

/// A frame of `value(row, column)`, taken with one known time.
fn frame(shape: Shape, time_us: f64, value: impl FnMut(usize, usize) -> f32) -> Frame {
    let mut frame = Frame::new(shape);
    frame.amplitude = Plane::from_fn(shape, value);
    frame.integration_time_us = IntegrationTime::PerFrame(time_us);
    frame
}

/// The evaluator after all `frames`, the reference being `frames[reference]`.
fn evaluator(frames: &[Frame], reference: Option<usize>) -> Evaluator {
    let mut evaluator = Evaluator::new(frames[0].shape(), EvaluationSettings::default());
    if let Some(reference) = reference {
        evaluator.set_reference(&EvaluationFrame::of_raw(&frames[reference])).unwrap();
    }
    for frame in frames {
        evaluator.push(&EvaluationFrame::of_raw(frame)).unwrap();
    }
    evaluator
}

fn evaluate(frames: &[Frame], reference: Option<usize>) -> Evaluation {
    evaluator(frames, reference).finish()
}

/// The same frames with every amplitude changed.
fn map(frames: &[Frame], mut change: impl FnMut(&Frame, usize, f32) -> f32) -> Vec<Frame> {
    let mut changed = frames.to_vec();
    for (changed, frame) in changed.iter_mut().zip(frames) {
        for (index, value) in changed.amplitude.values_mut().iter_mut().enumerate() {
            *value = change(frame, index, *value);
        }
    }
    changed
}

/// Normal deviates by Box and Muller from a 64-bit linear congruential generator (Knuth's MMIX).
struct Normal(u64);

impl Normal {
    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 11) as f64 + 0.5) / (1u64 << 53) as f64
    }

    fn next(&mut self) -> f64 {
        let radius = (-2.0 * self.uniform().ln()).sqrt();
        radius * (std::f64::consts::TAU * self.uniform()).cos()
    }
}

fn assert_near(found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() <= tolerance, "found {found}, expected {expected} ± {tolerance}");
}

fn invalidate(frame: &mut Frame, index: usize, value: f32) {
    frame.flags.values_mut()[index].insert(PixelFlags::INVALID);
    frame.amplitude.values_mut()[index] = value;
}
