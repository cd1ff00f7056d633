//! What a person sees: results on stdout, progress and notes on stderr.

use std::fmt::Display;
use std::io::{self, Write};
use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};

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

/// A progress bar over `frames`; invisible unless stderr is a terminal.
pub(crate) fn progress(what: &str, frames: usize) -> ProgressBar {
    let bar = ProgressBar::new(frames as u64);
    let template = "{prefix:>22} [{bar:32}] {pos}/{len} frames, {per_sec}, {eta} left";
    if let Ok(style) = ProgressStyle::with_template(template) {
        bar.set_style(style.progress_chars("=> "));
    }
    bar.set_prefix(what.to_owned());
    bar.enable_steady_tick(Duration::from_millis(200));
    bar
}

/// A spinner whose message is the step at hand; invisible unless stderr is a terminal.
pub(crate) fn steps() -> ProgressBar {
    let spinner = ProgressBar::new_spinner();
    if let Ok(style) = ProgressStyle::with_template("{spinner} {elapsed} {msg}") {
        spinner.set_style(style);
    }
    spinner.enable_steady_tick(Duration::from_millis(200));
    spinner
}

/// Lays out rows in columns, two spaces apart. The first column is aligned left, all others right.
pub(crate) fn table(rows: &[Vec<String>]) -> String {
    let columns = rows.iter().map(Vec::len).max().unwrap_or(0);
    let width =
        |column: usize| rows.iter().filter_map(|row| row.get(column)).map(|cell| cell.chars().count()).max();
    let widths: Vec<usize> = (0..columns).map(|column| width(column).unwrap_or(0)).collect();
    let line = |row: &Vec<String>| {
        let cells = row.iter().zip(&widths).enumerate().map(|(column, (cell, &width))| {
            if column == 0 { format!("{cell:<width$}") } else { format!("{cell:>width$}") }
        });
        cells.collect::<Vec<_>>().join("  ").trim_end().to_owned()
    };
    rows.iter().map(line).collect::<Vec<_>>().join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_line_up_by_characters() {
        let row = |cells: [&str; 3]| cells.map(str::to_owned).to_vec();
        let text = table(&[row(["t in µs", "n", "S"]), row(["200", "17", "41.0"])]);
        assert_eq!(text, "t in µs   n     S\n200      17  41.0");
    }
}
