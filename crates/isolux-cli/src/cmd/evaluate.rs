//! `isolux evaluate`: how much better is it?

use isolux::evaluate::{
    Comparison, ComparisonRow, EvaluationFrame, EvaluationSettings, Evaluator, Unavailable, nearest_reference,
};
use isolux::motion::MotionWatch;
use isolux::{Calibration, Channels, Frame, IntegrationTime, PixelFlags, Plane, Standardized, Standardizer};
use isolux_io::Recording;
use serde_json::json;

use crate::args::EvaluateArgs;
use crate::console::{self, table};
use crate::failure::{Failure, Outcome};
use crate::frames;

pub(crate) fn run(args: &EvaluateArgs) -> Outcome {
    let calibration = frames::calibration(args.calibration.as_deref())?;
    let mut recording = isolux_io::open(&args.recording)?;
    let standardizer =
        Standardizer::plan(&args.steps.choice()?, calibration.as_ref(), recording.metadata().available)?;
    standardizer.notes().iter().for_each(console::note);
    let pixels = if args.trusted { Pixels::Trusted } else { Pixels::Valid };
    let comparison = compare(&mut *recording, &standardizer, calibration.as_ref(), pixels)?;
    if args.json {
        let steps: Vec<&str> = standardizer.steps().iter().map(|step| step.term).collect();
        return console::print_json(&json!({"steps": steps, "comparison": comparison}));
    }
    console::print(describe(&comparison))
}

/// Which pixels count.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Pixels {
    /// Before and after, those with a value.
    Valid,
    /// Before and after the same: those with a standardized value and neither LOW_SIGNAL nor SATURATED.
    Trusted,
}

/// Evaluates the raw and the standardized amplitude of the same frames. Two passes: one over the integration
/// times to find the reference exposure, one over the frames.
pub(crate) fn compare(
    recording: &mut dyn Recording,
    standardizer: &Standardizer,
    calibration: Option<&Calibration>,
    pixels: Pixels,
) -> Outcome<Comparison> {
    let metadata = recording.metadata().clone();
    let reference_us = calibration
        .and_then(|c| c.reference.integration_time_us)
        .unwrap_or(isolux::calibration::REFERENCE_TIME_US);
    let mut evaluation = Both::new(&metadata, standardizer, pixels);
    let wanted = standardizer.needed() | Channels::DISTANCE | Channels::INTEGRATION_TIME | Channels::TARGET;
    if let Some(index) = reference_frame(recording, reference_us)? {
        let mut frame = Frame::new(metadata.shape);
        recording.read_frame(index, wanted, &mut frame)?;
        evaluation.take(&frame, Both::set_reference).map_err(|e| Failure::frame(&metadata.path, index, e))?;
    }
    let (mut motion, mut last_us) = (MotionWatch::default(), None);
    frames::for_each(recording, wanted, "evaluating", |index, frame| {
        if let IntegrationTime::PerFrame(time_us) = frame.integration_time_us
            && last_us.replace(time_us) != Some(time_us)
        {
            motion.push(time_us, frame);
        }
        evaluation.take(frame, Both::push).map_err(|error| Failure::frame(&metadata.path, index, error))
    })?;
    if let Some(movement) = motion.verdict() {
        console::warn(format!(
            "the scene did not stand still ({:.0} % of it is elsewhere at {} µs): figures over integration times \
             also show its movement",
            100.0 * movement.share,
            movement.integration_time_us
        ));
    }
    Ok(Comparison::new(&evaluation.before, &evaluation.after))
}

fn reference_frame(recording: &mut dyn Recording, reference_us: f64) -> Outcome<Option<usize>> {
    let mut times = Vec::new();
    frames::for_each(recording, Channels::INTEGRATION_TIME, "reading times", |_, frame| {
        times.push(match frame.integration_time_us {
            IntegrationTime::PerFrame(time_us) => Some(time_us),
            IntegrationTime::Unknown | IntegrationTime::PerPixel(_) => None,
        });
        Ok(())
    })?;
    Ok(nearest_reference(times, reference_us))
}

/// The two evaluators and what makes the second's frames.
struct Both<'a> {
    standardizer: &'a Standardizer,
    pixels: Pixels,
    out: Standardized,
    trusted: Plane<PixelFlags>,
    before: Evaluator,
    after: Evaluator,
}

impl<'a> Both<'a> {
    fn new(metadata: &isolux_io::Metadata, standardizer: &'a Standardizer, pixels: Pixels) -> Self {
        let evaluator = || Evaluator::new(metadata.shape, EvaluationSettings::default());
        let out = Standardized::new(metadata.shape);
        let trusted = Plane::filled(metadata.shape, PixelFlags::empty());
        Self { standardizer, pixels, out, trusted, before: evaluator(), after: evaluator() }
    }

    fn take(
        &mut self,
        frame: &Frame,
        pass: fn(&mut Evaluator, &EvaluationFrame<'_>) -> Result<(), isolux::ShapeError>,
    ) -> Result<(), isolux::standardize::StandardizeError> {
        self.standardizer.apply(frame, &mut self.out)?;
        let (before_flags, after_flags) = match self.pixels {
            Pixels::Valid => (&frame.flags, &self.out.flags),
            Pixels::Trusted => {
                mark_distrusted(&self.out.flags, &mut self.trusted);
                (&self.trusted, &self.trusted)
            }
        };
        pass(&mut self.before, &EvaluationFrame::of_standardized(frame, &frame.amplitude, before_flags))?;
        Ok(pass(&mut self.after, &EvaluationFrame::of_standardized(frame, &self.out.amplitude, after_flags))?)
    }

    fn set_reference(
        evaluator: &mut Evaluator,
        frame: &EvaluationFrame<'_>,
    ) -> Result<(), isolux::ShapeError> {
        evaluator.set_reference(frame)
    }

    fn push(evaluator: &mut Evaluator, frame: &EvaluationFrame<'_>) -> Result<(), isolux::ShapeError> {
        evaluator.push(frame)
    }
}

/// The flags with INVALID where a pixel is LOW_SIGNAL or SATURATED.
fn mark_distrusted(flags: &Plane<PixelFlags>, out: &mut Plane<PixelFlags>) {
    let distrusted = PixelFlags::LOW_SIGNAL | PixelFlags::SATURATED;
    for (out, &flags) in out.values_mut().iter_mut().zip(flags.values()) {
        *out = if flags.intersects(distrusted) { flags | PixelFlags::INVALID } else { flags };
    }
}

/// The figures as a table; those that the recording cannot tell are listed below with the reason.
pub(crate) fn describe(comparison: &Comparison) -> String {
    describe_rows(comparison, |_| true)
}

/// Like [`describe`], for the figures whose name is wanted.
pub(crate) fn describe_rows(comparison: &Comparison, wanted: impl Fn(&str) -> bool) -> String {
    let header = ["figure", "before", "after", "better", "valid before", "valid after"];
    let mut rows = vec![header.map(str::to_owned).to_vec()];
    let mut missing: Vec<(Unavailable, Vec<String>)> = Vec::new();
    for row in comparison.rows().into_iter().filter(|row| wanted(&row.metric)) {
        match (row.before, row.after) {
            (Err(reason), _) | (_, Err(reason)) => {
                match missing.iter_mut().find(|(known, _)| *known == reason) {
                    Some((_, metrics)) => metrics.push(row.metric),
                    None => missing.push((reason, vec![row.metric])),
                }
            }
            (Ok(before), Ok(after)) => rows.push(line(&row, before, after)),
        }
    }
    let mut text = table(&rows);
    for (reason, metrics) in missing {
        text += &format!("\nnot told by this recording, since {reason}:\n  {}", metrics.join("\n  "));
    }
    text
}

fn line(row: &ComparisonRow, before: f64, after: f64) -> Vec<String> {
    let value = |value: f64| match row.unit {
        "ratio" => format!("{:.2} %", 100.0 * value),
        unit => format!("{value:.3} {unit}"),
    };
    let share = |share: Option<f64>| share.map_or_else(|| "-".to_owned(), |s| format!("{:.1} %", 100.0 * s));
    let better = match row.better {
        isolux::evaluate::Better::Lower => "lower",
        isolux::evaluate::Better::Higher => "higher",
        isolux::evaluate::Better::TowardsZero => "towards 0",
    };
    vec![
        row.metric.clone(),
        value(before),
        value(after),
        better.to_owned(),
        share(row.before_valid_fraction),
        share(row.after_valid_fraction),
    ]
}
