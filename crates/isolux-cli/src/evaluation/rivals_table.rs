//! The chosen chain beside its rivals, as a table for the terminal.

use isolux_pipeline::Assessment;
use isolux_pipeline::figures::{CHOSEN, chain_heads, chain_rows, unavailable};

use crate::terminal::table;

/// The figures of every chain on the same frames, each with the share of values behind it.
pub(crate) fn rivals_table(assessment: &Assessment, chosen: &[&str]) -> String {
    let told = chain_rows(assessment).into_iter().filter(|row| row.is_told).map(|row| row.cells);
    let rows: Vec<_> = [chain_heads(assessment)].into_iter().chain(told).collect();
    let mut text = format!("In brackets: the share of the values behind a figure.\n{}", table(&rows));
    for rival in &assessment.rivals {
        text += &format!("\n{}: {}", rival.name, rival.steps.join(", "));
    }
    text += &format!("\n{CHOSEN}: {}", chosen.join(", "));
    text + &unavailable(&assessment.comparison.rows())
}
