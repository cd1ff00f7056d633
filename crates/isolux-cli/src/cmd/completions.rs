//! `isolux completions`: completions for the shell.

use clap::CommandFactory;

use crate::failure::{Failure, Outcome};
use crate::options::{Cli, CompletionsArgs};

pub(crate) fn run(args: &CompletionsArgs) -> Outcome {
    // Into memory first: the generator panics on a closed pipe.
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut Cli::command(), "isolux", &mut script);
    let text = String::from_utf8(script).map_err(|error| Failure::data(format!("completions: {error}")))?;
    crate::terminal::print(text.trim_end())
}
