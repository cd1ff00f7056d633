//! What observations know of each factor of the joint model, as a table.

use isolux::calibrate::joint::{Factor, Finding};

use crate::terminal::table;

pub(super) fn findings(findings: &[Finding]) -> String {
    let heads = ["  factor", "standard error", "condition", "free spread", "verdict"];
    let mut rows = vec![heads.map(str::to_owned).to_vec()];
    rows.extend(findings.iter().map(finding));
    table(&rows)
}

fn finding(finding: &Finding) -> Vec<String> {
    let spread = finding.free_spread.map(|spread| match finding.factor {
        Factor::Distance => format!("{spread:.3} of ln d"),
        _ => format!("{spread:.3} of ln cosθ"),
    });
    vec![
        format!("  {}", finding.factor.name()),
        format!("{:.2} %", 100.0 * finding.standard_error),
        format!("{:.1}", finding.inflation),
        spread.unwrap_or_else(|| "-".to_owned()),
        if finding.refusal.is_some() { "refused" } else { "determined" }.to_owned(),
    ]
}
