//! Results on stdout, notes and warnings on stderr.

use std::fmt::Display;
use std::io::{self, Write};

use crate::failure::{Failure, Outcome};

/// Prints a result. A closed pipe (`isolux info REC | head -1`) ends the output, not the command.
pub(crate) fn print(text: impl Display) -> Outcome {
    match writeln!(io::stdout(), "{text}") {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            Err(Failure::data(format!("cannot write to standard output: {error}")))
        }
        _ => Ok(()),
    }
}

/// Prints a value as JSON.
pub(crate) fn print_json(value: &impl serde::Serialize) -> Outcome {
    print(
        serde_json::to_string_pretty(value)
            .map_err(|error| Failure::data(format!("cannot print JSON: {error}")))?,
    )
}

/// Prints a remark that is no result.
pub(crate) fn note(text: impl Display) {
    // Nothing can be done about a standard error that is closed.
    let _ = writeln!(io::stderr(), "note: {text}");
}

/// Prints a remark about something that may spoil the result.
pub(crate) fn warn(text: impl Display) {
    let _ = writeln!(io::stderr(), "warning: {text}");
}
