//! `isolux standardize`: a recording in, a standardized recording out.

use isolux_pipeline::standardize::{NativeSink, StandardizeOptions, step_json, steps};
use isolux_pipeline::{Brackets, FrameSource, Summary, plan_with};
use serde_json::{Value, json};

use crate::failure::Outcome;
use crate::options::StandardizeArgs;
use crate::output;
use crate::terminal::{self, Terminal, interrupt};

pub(crate) fn run(args: &StandardizeArgs) -> Outcome {
    let inputs = [Some(args.recording.as_path()), args.calibration.as_deref()];
    output::keep_clear_of(&args.output, inputs.into_iter().flatten())?;
    let calibration = args.calibration.as_deref().map(isolux_io::read_calibration).transpose()?;
    let mut recording = isolux_io::open(&args.recording)?;
    let observer = Terminal::default();
    let (choice, traits) = (args.steps.choice()?, args.steps.traits(recording.facts().traits()));
    let standardizer = plan_with(&choice, calibration.as_ref(), traits, &mut recording, &observer)?;
    let brackets = args.merge_bracket.map(|length| Brackets::plan(&mut recording, length, &observer));
    let brackets = brackets.transpose()?;
    let options = StandardizeOptions {
        calibration: calibration.as_ref(),
        keep_input: args.keep_input,
        threads: args.threads.map(usize::from),
        brackets: brackets.as_ref(),
    };
    interrupt::watch();
    let mut sink = NativeSink::new(&args.output, args.force);
    let summary =
        isolux_pipeline::standardize(&mut recording, &standardizer, &options, &mut sink, &observer)?;
    let steps = steps(&standardizer, brackets.as_ref());
    if args.json {
        let steps: Vec<Value> = steps.iter().map(step_json).collect();
        return terminal::print_json(&json!({"steps": steps, "summary": summary}));
    }
    for step in steps {
        terminal::print(format!("{:>9}: {} ({})", step.effect, step.term, step.parameters))?;
    }
    terminal::print(describe(&summary))?;
    terminal::print(format!("written: {}", args.output.display()))
}

/// How many pixels have a value, and how many of these a value that can be trusted.
fn validity(summary: &Summary) -> String {
    let share = |count: usize, of: usize| format!("{:.2} %", 100.0 * count as f64 / of.max(1) as f64);
    let valid = share(summary.valid, summary.pixels);
    match summary.within_range {
        within if within == summary.valid => format!("{valid} of the pixels valid"),
        0 => format!("no pixel within the calibrated ranges; {valid} have a value, which is extrapolated"),
        within => format!(
            "{} of the pixels valid and within the calibrated ranges, {valid} with those that are extrapolated",
            share(within, summary.pixels)
        ),
    }
}

fn describe(summary: &Summary) -> String {
    let share = |count: usize| format!("{:.2} %", 100.0 * count as f64 / summary.pixels.max(1) as f64);
    let mut lines = vec![format!("{} frames, {}", summary.frames, validity(summary))];
    let remarks = [
        (summary.time_refused, "refused: integration time above the calibrated range, or unknown"),
        (summary.time_extrapolated, "outside the calibrated integration times, continued as 1/t (flagged)"),
        (summary.distance_extrapolated, "outside the calibrated distances, continued as d² (flagged)"),
        (
            summary.illumination_extrapolated,
            "outside the profile's support or steeper than was seen (flagged)",
        ),
        (summary.specular, "limited as specular (flagged)"),
    ];
    lines.extend(
        remarks
            .into_iter()
            .filter(|(count, _)| *count > 0)
            .map(|(count, what)| format!("{:>9} {what}", share(count))),
    );
    lines.join("\n")
}
