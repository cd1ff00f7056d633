//! Standardize one frame: first with textbook physics, then with a calibration of the camera.
//!
//! The frame comes from a simulated camera. For your own, fill a [`Frame`] with an amplitude image, a distance image in
//! metres and the integration time in µs, then call [`Frame::flag_amplitude`].
#![allow(clippy::print_stdout, reason = "an example shows its result")]

mod simulated;

use std::error::Error;

use isolux::{Channels, Choice, Frame, Plane, RecordingTraits, Standardizer};

fn main() -> Result<(), Box<dyn Error>> {
    // A desk, at 16.2 ms: twice the reference time.
    let frame = simulated::record("office-desk")?.swap_remove(33);

    // What the plan must know of a recording: which channels its frames have. Shape, intrinsics and modulation
    // frequency are optional.
    let channels =
        Channels::AMPLITUDE | Channels::INTENSITY | Channels::DISTANCE | Channels::INTEGRATION_TIME;
    let traits = RecordingTraits::from(channels);

    // The default choice takes the best steps that the calibration allows. Without a calibration, these are
    // t_ref / t and (d / d_ref)².
    let choice = Choice::default();
    let textbook = Standardizer::plan(&choice, None, traits.clone())?;
    show("without a calibration", &textbook, &frame)?;

    // The calibration knows how this camera saturates, and its own law over distance.
    let calibration = simulated::calibration()?;
    let calibrated = Standardizer::plan(&choice, Some(&calibration), traits)?;
    show("with a calibration", &calibrated, &frame)
}

/// Standardizes one frame and prints what became of it.
fn show(title: &str, standardizer: &Standardizer, frame: &Frame) -> Result<(), Box<dyn Error>> {
    println!("{title}:");
    for step in standardizer.steps() {
        println!("  step {}: {}", step.term, step.parameters);
    }
    for note in standardizer.notes() {
        println!("  note: {note}");
    }
    // A stream owns the memory that the steps need. Push one frame, or thousands.
    let mut stream = standardizer.stream();
    let out = stream.push(frame)?;
    println!("  {} of {} pixels have a value", out.summary.valid, out.summary.pixels);
    let (row, column) = (20, 120);
    let value = |image: &Plane<f32>| image.get(row, column).unwrap_or(f32::NAN);
    let (before, after) = (value(&frame.amplitude), value(&out.amplitude));
    println!("  pixel ({row}, {column}): {before:.1} DN before, {after:.1} DN after");
    Ok(())
}
