//! `isolux`: standardizes the amplitude images of time-of-flight cameras.

mod advice;
mod args;
mod assessment;
mod beside;
mod chain;
mod cmd;
mod console;
mod evaluation_page;
mod failure;
mod frames;
mod interrupt;
mod option_values;
mod output;
mod rivals;
mod sigma;
mod step_args;

use std::io::Write;
use std::process::ExitCode;

use clap::Parser;

use args::{Cli, Command};

fn main() -> ExitCode {
    let outcome = match Cli::parse().command {
        Command::Demo(args) => cmd::demo::run(&args),
        Command::Info(args) => cmd::info::run(&args),
        Command::Calibrate(args) => cmd::calibrate::run(&args),
        Command::Standardize(args) => cmd::standardize::run(&args),
        Command::Evaluate(args) => cmd::evaluate::run(&args),
        Command::Diagnose(args) => cmd::diagnose::run(&args),
        Command::Simulate(args) => cmd::simulate::run(&args),
        Command::Paper(args) => cmd::paper::run(&args),
        Command::Figures(args) => cmd::figures::run(&args),
        Command::Completions(args) => cmd::completions::run(&args),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            // Nothing can be done about a standard error that is closed.
            let _ = writeln!(std::io::stderr(), "error: {failure}");
            failure.exit_code()
        }
    }
}
