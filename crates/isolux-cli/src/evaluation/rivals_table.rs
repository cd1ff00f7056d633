//! The chosen chain beside its rivals, as a table for the terminal and one for the page.

use isolux::evaluate::ComparisonRow;
use isolux_pipeline::Assessment;
use isolux_report::page::{Cell, Table};

use super::words::{direction, untold, written};
use crate::terminal::table;

/// The figures of every chain on the same frames, each with the share of values behind it.
pub(crate) fn rivals_table(assessment: &Assessment, chosen: &[&str]) -> String {
    let chains = chains(assessment);
    let mut rows = vec![vec!["figure".to_owned(), "better".to_owned(), "raw".to_owned()]];
    rows[0].extend(names(assessment));
    let ours = assessment.comparison.rows();
    for (index, row) in ours.iter().enumerate().filter(|(_, row)| row.is_told()) {
        let raw = cell(row, &row.before, row.before_valid_fraction);
        let mut line = vec![row.metric.clone(), direction(row.better).to_owned(), raw];
        line.extend(chains.iter().filter_map(|rows| rows.get(index)).map(after));
        rows.push(line);
    }
    let mut text = format!("In brackets: the share of the values behind a figure.\n{}", table(&rows));
    for rival in &assessment.rivals {
        text += &format!("\n{}: {}", rival.name, rival.steps.join(", "));
    }
    text += &format!("\n{CHOSEN}: {}", chosen.join(", "));
    text + &untold(&ours)
}

/// The same for a page.
pub(super) fn page_table(id: &str, assessment: &Assessment) -> Table {
    let chains = chains(assessment);
    let mut columns = vec!["figure".to_owned(), "better".to_owned(), "raw".to_owned()];
    columns.extend(names(assessment));
    let row = |(index, row): (usize, &ComparisonRow)| {
        let mut cells = vec![row.metric.clone(), direction(row.better).to_owned()];
        cells.push(cell(row, &row.before, row.before_valid_fraction));
        cells.extend(chains.iter().filter_map(|rows| rows.get(index)).map(after));
        cells.into_iter().map(Cell::Text).collect()
    };
    Table {
        id: format!("{id}-beside"),
        caption: "The same frames by the textbook's chain (A d²/t), the paper's and the chosen one; in brackets the \
                  share of the values behind each figure."
            .to_owned(),
        columns,
        rows: chains[0].iter().enumerate().map(row).collect(),
    }
}

const CHOSEN: &str = "chosen";
const MISSING: &str = "-";

fn names(assessment: &Assessment) -> impl Iterator<Item = String> {
    assessment.rivals.iter().map(|rival| rival.name).chain([CHOSEN]).map(str::to_owned)
}

/// The rows of every rival, then of the chosen chain: all have the same figures in the same order, since the strata
/// are those of the raw amplitude.
fn chains(assessment: &Assessment) -> Vec<Vec<ComparisonRow>> {
    let comparisons = assessment.rivals.iter().map(|rival| &rival.comparison);
    comparisons.chain([&assessment.comparison]).map(isolux::evaluate::Comparison::rows).collect()
}

fn after(row: &ComparisonRow) -> String {
    cell(row, &row.after, row.after_valid_fraction)
}

fn cell(row: &ComparisonRow, value: &isolux::evaluate::Outcome<f64>, valid: Option<f64>) -> String {
    match value {
        Ok(value) => {
            let share = valid.map_or_else(String::new, |share| format!(" ({:.1} %)", 100.0 * share));
            written(row, *value) + &share
        }
        Err(_) => MISSING.to_owned(),
    }
}
