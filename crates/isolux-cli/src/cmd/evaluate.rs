//! `isolux evaluate`: how much better is it?

use std::path::Path;

use isolux::evaluate::{Better, Comparison, ComparisonRow, Unavailable};
use isolux::{Calibration, Standardizer};
use isolux_io::Recording;
use serde_json::json;

use crate::args::EvaluateArgs;
use crate::assessment::{Assessment, Pixels, assess};
use crate::console::{self, table};
use crate::evaluation_page;
use crate::failure::{Failure, Outcome};
use crate::rivals::Rivals;
use crate::{beside, frames, output, sigma};

pub(crate) fn run(args: &EvaluateArgs) -> Outcome {
    let inputs = [Some(args.recording.as_path()), args.calibration.as_deref()];
    if let Some(report) = &args.report {
        output::keep_clear_of(report, inputs.into_iter().flatten())?;
    }
    let calibration = frames::calibration(args.calibration.as_deref())?;
    let mut recording = isolux_io::open(&args.recording)?;
    let standardizer = sigma::plan(&args.steps, calibration.as_ref(), &mut *recording)?;
    let pixels = if args.trusted { Pixels::Trusted } else { Pixels::Valid };
    let rivals = if args.alone {
        Rivals::none()
    } else {
        let metadata = recording.metadata();
        Rivals::new(&standardizer, calibration.as_ref(), frames::stream(metadata), metadata.shape)
    };
    let assessment = assess(&mut *recording, &standardizer, calibration.as_ref(), pixels, rivals)?;
    if let Some(report) = &args.report {
        write_page(&mut *recording, &standardizer, calibration.as_ref(), &assessment, report)?;
    }
    if args.json {
        let steps: Vec<&str> = standardizer.steps().iter().map(|step| step.term).collect();
        let beside = assessment.rivals.iter().map(
            |rival| json!({"name": rival.name, "steps": rival.steps, "figures": rival.comparison.after}),
        );
        let beside: Vec<_> = beside.collect();
        return console::print_json(
            &json!({"steps": steps, "comparison": assessment.comparison, "beside": beside}),
        );
    }
    if assessment.rivals.is_empty() {
        return console::print(describe(&assessment.comparison));
    }
    let steps: Vec<&str> = standardizer.steps().iter().map(|step| step.term).collect();
    console::print(beside::describe(&assessment, &steps))
}

/// One page that needs nothing beside it.
fn write_page(
    recording: &mut dyn Recording,
    standardizer: &Standardizer,
    calibration: Option<&Calibration>,
    assessment: &Assessment,
    report: &Path,
) -> Outcome {
    let pictures = evaluation_page::pictures(recording, standardizer, &assessment.shown_frames, "recording")?;
    let page = evaluation_page::page(recording.metadata(), standardizer, calibration, assessment, pictures);
    let html = isolux_report::render_with(&page, isolux_report::Companions::Absent).map_err(Failure::data)?;
    isolux_io::write_whole(report, html.as_bytes())
        .map_err(|error| Failure::data(format!("cannot write `{}`: {error}", report.display())))
}

/// The figures as a table; those that the recording cannot tell are listed below with the reason.
pub(crate) fn describe(comparison: &Comparison) -> String {
    describe_rows(comparison, |_| true)
}

/// Like [`describe`], for the figures whose name is wanted.
pub(crate) fn describe_rows(comparison: &Comparison, wanted: impl Fn(&str) -> bool) -> String {
    let header = ["figure", "before", "after", "better", "valid before", "valid after"];
    let mut rows = vec![header.map(str::to_owned).to_vec()];
    let found: Vec<ComparisonRow> = comparison.rows().into_iter().filter(|row| wanted(&row.metric)).collect();
    rows.extend(found.iter().filter(|row| row.is_told()).filter_map(line));
    table(&rows) + &untold(&found)
}

/// The figures that the recording does not tell, by reason; empty where it tells all.
pub(crate) fn untold(rows: &[ComparisonRow]) -> String {
    let mut missing: Vec<(Unavailable, Vec<&str>)> = Vec::new();
    for row in rows.iter().filter(|row| !row.is_told()) {
        let reason = (row.before, row.after);
        if let (Err(Unavailable::NoSigma), Err(reason)) | (Err(reason), _) | (_, Err(reason)) = reason {
            match missing.iter_mut().find(|(known, _)| *known == reason) {
                Some((_, metrics)) => metrics.push(&row.metric),
                None => missing.push((reason, vec![&row.metric])),
            }
        }
    }
    let mut text = String::new();
    for (reason, metrics) in missing {
        text += &format!("\nnot told by this recording, since {reason}:\n  {}", metrics.join("\n  "));
    }
    text
}

/// `None` where there is no value after.
fn line(row: &ComparisonRow) -> Option<Vec<String>> {
    let value = |value| written(row, value);
    let share = |share: Option<f64>| share.map_or_else(|| "-".to_owned(), |s| format!("{:.1} %", 100.0 * s));
    Some(vec![
        row.metric.clone(),
        row.before.map_or_else(|_| "-".to_owned(), value),
        value(row.after.ok()?),
        direction(row.better).to_owned(),
        share(row.before_valid_fraction),
        share(row.after_valid_fraction),
    ])
}

/// A figure with its unit.
pub(crate) fn written(row: &ComparisonRow, value: f64) -> String {
    match row.unit {
        "ratio" => format!("{:.2} %", 100.0 * value),
        unit => format!("{value:.3} {unit}"),
    }
}

/// Where a figure should go, in words.
pub(crate) fn direction(better: Better) -> &'static str {
    match better {
        Better::Lower => "lower",
        Better::Higher => "higher",
        Better::TowardsZero => "towards 0",
        Better::TowardsNormal => "towards 68.3 %",
    }
}
