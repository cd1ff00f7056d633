//! `isolux evaluate`: how much better is it?

use std::path::Path;

use isolux::{Calibration, Standardizer};
use isolux_io::Recording;
use isolux_pipeline::assess::Pixels;
use isolux_pipeline::page::{page, pictures};
use isolux_pipeline::{AssessOptions, Assessment, FrameSource, assess, plan_with};
use serde_json::json;

use crate::evaluation::{figures_table, rivals_table};
use crate::failure::{Failure, Outcome};
use crate::options::EvaluateArgs;
use crate::output;
use crate::terminal::{self, Terminal};

pub(crate) fn run(args: &EvaluateArgs) -> Outcome {
    let inputs = [Some(args.recording.as_path()), args.calibration.as_deref()];
    if let Some(report) = &args.report {
        output::keep_clear_of(report, inputs.into_iter().flatten())?;
    }
    let calibration = args.calibration.as_deref().map(isolux_io::read_calibration).transpose()?;
    let mut recording = isolux_io::open(&args.recording)?;
    let observer = Terminal::default();
    let (choice, traits) = (args.steps.choice()?, args.steps.traits(recording.facts().traits()));
    let standardizer = plan_with(&choice, calibration.as_ref(), traits, &mut recording, &observer)?;
    let options = AssessOptions {
        calibration: calibration.as_ref(),
        pixels: if args.trusted { Pixels::Trusted } else { Pixels::Valid },
        rivals: !args.alone,
    };
    let assessment = assess(&mut recording, &standardizer, &options, &observer)?;
    if let Some(report) = &args.report {
        write_page(&mut recording, &standardizer, calibration.as_ref(), &assessment, report)?;
    }
    let steps: Vec<&str> = standardizer.steps().iter().map(|step| step.term).collect();
    if args.json {
        let beside = assessment.rivals.iter().map(
            |rival| json!({"name": rival.name, "steps": rival.steps, "figures": rival.comparison.after}),
        );
        let beside: Vec<_> = beside.collect();
        return terminal::print_json(
            &json!({"steps": steps, "comparison": assessment.comparison, "beside": beside}),
        );
    }
    if assessment.rivals.is_empty() {
        return terminal::print(figures_table(&assessment.comparison, |_| true));
    }
    terminal::print(rivals_table(&assessment, &steps))
}

/// One page that needs nothing beside it.
fn write_page(
    recording: &mut Box<dyn Recording>,
    standardizer: &Standardizer,
    calibration: Option<&Calibration>,
    assessment: &Assessment,
    report: &Path,
) -> Outcome {
    let pictures = pictures(recording, standardizer, &assessment.shown_frames, "recording")?;
    let page = page(&recording.facts(), standardizer, calibration, assessment, pictures, "`isolux evaluate`");
    let html = isolux_report::render_with(&page, isolux_report::Companions::Absent).map_err(Failure::data)?;
    isolux_io::write_whole(report, html.as_bytes())
        .map_err(|error| Failure::data(format!("cannot write `{}`: {error}", report.display())))
}
