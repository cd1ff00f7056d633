//! The figures of an assessment in words, for tables and pages.

use isolux::evaluate::{Better, Comparison, ComparisonRow, Outcome, Unavailable};

use crate::assess::Assessment;

/// Name of the chain that was asked for, beside its rivals.
pub const CHOSEN: &str = "chosen";
const MISSING: &str = "-";

/// One figure of all chains on the same frames.
#[derive(Clone, Debug)]
pub struct ChainRow {
    /// True when the recording determines the figure.
    pub is_told: bool,
    /// Its name, where it should go, its value of the raw amplitude and of every chain, each with the share of the
    /// values behind it in brackets.
    pub cells: Vec<String>,
}

/// The heads of the columns of [`chain_rows`].
#[must_use]
pub fn chain_heads(assessment: &Assessment) -> Vec<String> {
    let chains = assessment.rivals.iter().map(|rival| rival.name).chain([CHOSEN]);
    ["figure", "better", "raw"].into_iter().chain(chains).map(str::to_owned).collect()
}

/// The figures of every rival, then of the chosen chain. All have the same figures in the same order, since the strata
/// are those of the raw amplitude.
#[must_use]
pub fn chain_rows(assessment: &Assessment) -> Vec<ChainRow> {
    let comparisons = assessment.rivals.iter().map(|rival| &rival.comparison);
    let chains: Vec<_> = comparisons.chain([&assessment.comparison]).map(Comparison::rows).collect();
    let row = |(index, row): (usize, &ComparisonRow)| {
        let mut cells = vec![row.metric.clone(), direction(row.better).to_owned()];
        cells.push(cell(row, &row.before, row.before_valid_fraction));
        let after = chains.iter().filter_map(|rows| rows.get(index));
        cells.extend(after.map(|row| cell(row, &row.after, row.after_valid_fraction)));
        ChainRow { is_told: row.is_told(), cells }
    };
    assessment.comparison.rows().iter().enumerate().map(row).collect()
}

fn cell(row: &ComparisonRow, value: &Outcome<f64>, valid: Option<f64>) -> String {
    match value {
        Ok(value) => {
            let share = valid.map_or_else(String::new, |share| format!(" ({:.1} %)", 100.0 * share));
            written(row, *value) + &share
        }
        Err(_) => MISSING.to_owned(),
    }
}

/// A figure with its unit.
#[must_use]
pub fn written(row: &ComparisonRow, value: f64) -> String {
    match row.unit {
        "ratio" => format!("{:.2} %", 100.0 * value),
        unit => format!("{value:.3} {unit}"),
    }
}

/// Where a figure should go, in words.
#[must_use]
pub fn direction(better: Better) -> &'static str {
    match better {
        Better::Lower => "lower",
        Better::Higher => "higher",
        Better::TowardsZero => "towards 0",
        Better::TowardsNormal => "towards 68.3 %",
    }
}

/// The figures that the recording does not determine, grouped by reason; empty when it determines all.
#[must_use]
pub fn unavailable(rows: &[ComparisonRow]) -> String {
    let mut missing: Vec<(Unavailable, Vec<&str>)> = Vec::new();
    for row in rows.iter().filter(|row| !row.is_told()) {
        let reason = (row.before, row.after);
        if let (Err(Unavailable::NoSigma), Err(reason)) | (Err(reason), _) | (_, Err(reason)) = reason {
            match missing.iter_mut().find(|(known, _)| *known == reason) {
                Some((_, metrics)) => metrics.push(&row.metric),
                None => missing.push((reason, vec![&row.metric])),
            }
        }
    }
    let mut text = String::new();
    for (reason, metrics) in missing {
        text += &format!(
            "\ncannot be determined from this recording, since {reason}:\n  {}",
            metrics.join("\n  ")
        );
    }
    text
}
