//! The figures of one chain before and after, as a table for the terminal.

use isolux::evaluate::{Comparison, ComparisonRow};
use isolux_pipeline::figures::{direction, unavailable, written};

use crate::terminal::table;

/// The figures whose name is wanted; those that the recording cannot tell are listed below with the reason.
pub(crate) fn figures_table(comparison: &Comparison, wanted: impl Fn(&str) -> bool) -> String {
    let header = ["figure", "before", "after", "better", "valid before", "valid after"];
    let mut rows = vec![header.map(str::to_owned).to_vec()];
    let found: Vec<ComparisonRow> = comparison.rows().into_iter().filter(|row| wanted(&row.metric)).collect();
    rows.extend(found.iter().filter(|row| row.is_told()).filter_map(line));
    table(&rows) + &unavailable(&found)
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
