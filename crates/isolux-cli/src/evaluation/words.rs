//! Figures in words.

use isolux::evaluate::{Better, ComparisonRow, Unavailable};

/// A figure with its unit.
pub(super) fn written(row: &ComparisonRow, value: f64) -> String {
    match row.unit {
        "ratio" => format!("{:.2} %", 100.0 * value),
        unit => format!("{value:.3} {unit}"),
    }
}

/// Where a figure should go, in words.
pub(super) fn direction(better: Better) -> &'static str {
    match better {
        Better::Lower => "lower",
        Better::Higher => "higher",
        Better::TowardsZero => "towards 0",
        Better::TowardsNormal => "towards 68.3 %",
    }
}

/// The figures that the recording does not tell, by reason; empty where it tells all.
pub(super) fn untold(rows: &[ComparisonRow]) -> String {
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
        text += &format!("\nnot told by this recording, since {reason}:\n  {}", metrics.join("\n  "));
    }
    text
}
