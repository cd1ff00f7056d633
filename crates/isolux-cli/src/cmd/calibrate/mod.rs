//! `isolux calibrate`: sweeps, targets and scenes in, `CAMERA.json` out.

mod describe;
mod findings;
mod scenes;
mod targets;

use isolux::Reference;
use isolux::calibrate::{CalibrateSettings, FitWarning};
use isolux::calibration::Terms;
use isolux_pipeline::CalibrationPaths;

use crate::advice;
use crate::failure::{Failure, Outcome};
use crate::options::CalibrateArgs;
use crate::output;
use crate::terminal::{self, Terminal};

pub(crate) use describe::describe;

pub(crate) fn run(args: &CalibrateArgs) -> Outcome {
    let inputs = CalibrationPaths {
        exposure_sweeps: &args.exposure_sweep,
        distance_sweeps: &args.distance_sweep,
        targets: &args.target,
        scenes: &args.scene,
    };
    if inputs.all().next().is_none() {
        return Err(Failure::usage(
            "nothing to fit: give --exposure-sweep REC, --distance-sweep REC, --target REC or --scene REC, or several",
        ));
    }
    output::keep_clear_of(&args.output, inputs.all())?;
    output::expect_calibration_or_nothing(&args.output)?;
    let settings = CalibrateSettings {
        reference: Reference {
            integration_time_us: args.reference_time_us,
            distance_m: args.reference_distance_m,
        },
        window_px: usize::from(args.window),
        skip_frames: args.skip_frames,
        exclude_time_us: args.exclude_time_us.clone(),
        modulation_frequency_hz: None,
        accept_poor_fit: args.accept_poor_fit,
    };
    let observer = Terminal::default();
    let fitted = isolux_pipeline::calibrate(&settings, args.camera.clone(), inputs.open()?, &observer);
    // Of a failed fit, what was left out before it failed.
    let (calibration, report) = fitted.inspect_err(|error| error.warnings().iter().for_each(warn))?;
    report.warnings.iter().for_each(warn);
    if calibration.terms == Terms::default() {
        return Err(Failure::data(
            "no term could be fitted from these recordings, for the reasons above: no calibration is written",
        ));
    }
    isolux_io::write_calibration(&calibration, &args.output)?;
    if args.json {
        return terminal::print_json(&calibration);
    }
    terminal::print(describe(&calibration, &report))?;
    terminal::print(format!("written: {}", args.output.display()))
}

/// Prints what the user should know of a fit, with what can be done about it.
pub(crate) fn warn(warning: &FitWarning) {
    terminal::warn(advice::with(warning, warning.advice()));
}
