//! `isolux`: standardizes the amplitude images of time-of-flight cameras.

mod advice;
mod cmd;
mod evaluation;
mod failure;
mod options;
mod output;
mod terminal;

use std::io::Write;
use std::process::ExitCode;

use clap::Parser;

use options::{Cli, Command};

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
