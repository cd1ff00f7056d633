//! Evaluate a standardization: how much does a still scene vary over integration times, before and after?
#![allow(clippy::print_stdout, reason = "an example shows its result")]

mod simulated;

use std::error::Error;

use isolux::evaluate::{Comparison, EvaluationFrame, EvaluationSettings, Evaluator, nearest_reference};
use isolux::standardize::DenoiseStep;
use isolux::{Channels, Choice, DenoiseRule, Standardizer};

fn main() -> Result<(), Box<dyn Error>> {
    // A still desk, at integration times that neither leave it in the dark nor saturate it: what is not measured well
    // would dominate the figures.
    let mut frames = simulated::record("office-desk")?;
    frames
        .retain(|frame| frame.integration_time_us.at(0).is_some_and(|us| (4000.0..=16_200.0).contains(&us)));
    let calibration = simulated::calibration()?;
    let channels =
        Channels::AMPLITUDE | Channels::INTENSITY | Channels::DISTANCE | Channels::INTEGRATION_TIME;
    // The noise of the distance would go into the values: smooth it first.
    let denoise = Some(DenoiseStep::Smooth(DenoiseRule::Wiener));
    let choice = Choice { denoise, ..Choice::default() };
    let standardizer = Standardizer::plan(&choice, Some(&calibration), channels)?;
    let mut stream = standardizer.stream();

    // One evaluator sees the raw amplitude, the other the standardized amplitude of the same frames.
    let shape = frames[0].shape();
    let mut before = Evaluator::new(shape, EvaluationSettings::default());
    let mut after = Evaluator::new(shape, EvaluationSettings::default());

    // Some figures compare every frame with one reference frame: the one whose time is nearest to the reference time.
    let times_us = frames.iter().map(|frame| frame.integration_time_us.at(0));
    let reference_us = calibration.reference.integration_time_us.unwrap_or(8200.0);
    if let Some(index) = nearest_reference(times_us, reference_us) {
        let (frame, out) = (&frames[index], stream.push(&frames[index])?);
        before.set_reference(&raw_of(frame, out))?;
        after.set_reference(&EvaluationFrame::of_standardized(frame, &out.amplitude, &out.flags))?;
    }
    for frame in &frames {
        let out = stream.push(frame)?;
        before.push(&raw_of(frame, out))?;
        after.push(&EvaluationFrame::of_standardized(frame, &out.amplitude, &out.flags))?;
    }

    // A figure that these frames do not determine has no value; here, only those with a value are shown.
    println!("{:<60} {:>8} {:>8}", "figure", "before", "after");
    for row in Comparison::new(&before, &after).rows() {
        if let (Ok(before), Ok(after)) = (row.before, row.after) {
            println!("{:<60} {before:>8.3} {after:>8.3}  {}", row.metric, row.unit);
        }
    }
    Ok(())
}

/// The raw amplitude with the flags of the standardized frame, so that both evaluators look at the same pixels.
fn raw_of<'a>(frame: &'a isolux::Frame, out: &'a isolux::Standardized) -> EvaluationFrame<'a> {
    EvaluationFrame::of_standardized(frame, &frame.amplitude, &out.flags)
}
