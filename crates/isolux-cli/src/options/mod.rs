//! The command line, as clap reads it.

mod calibrate;
mod commands;
mod sigma;
mod steps;
mod values;

pub(crate) use calibrate::CalibrateArgs;
pub(crate) use commands::{
    Cli, Command, CompletionsArgs, DemoArgs, DiagnoseArgs, EvaluateArgs, FiguresArgs, InfoArgs, PaperArgs,
    SimulateArgs, StandardizeArgs,
};
