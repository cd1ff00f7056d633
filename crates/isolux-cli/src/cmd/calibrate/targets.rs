//! What the fit of targets found, in words and tables.

use isolux::calibrate::TargetReport;
use isolux::terms::{Angle, Profile};

use super::findings::findings;
use crate::terminal::table;

/// The gain at nine places of the image, and the part of it that is supported.
pub(super) fn profile(profile: &Profile) -> String {
    let places = profile.places();
    let thirds = |pixels: usize| [0.05, 0.5, 0.95].map(|share| share * (pixels as f64 - 1.0));
    let rows = thirds(profile.shape().height).map(|row| {
        let value = |column: f64| {
            let place = places.at(row, column);
            let mark = if profile.supports(place) { "" } else { " (not seen)" };
            format!("  {:.3}{mark}", profile.ln_gain(place).exp())
        };
        thirds(profile.shape().width).map(value).to_vec()
    });
    let cells: usize = profile.support.iter().map(|row| row.matches('#').count()).sum();
    let all = profile.support.len() * profile.support.first().map_or(0, String::len);
    let [row, column] = profile.places().origin;
    format!(
        "{}\nfor images of {}, 1 at row {row:.1}, column {column:.1}; seen in {:.0} % of the image",
        table(&rows),
        profile.shape(),
        100.0 * cells as f64 / all.max(1) as f64
    )
}

pub(super) fn angle(angle: &Angle) -> String {
    let [least, greatest] = angle.valid_cosine;
    format!(
        "cos^k θ, k = {:.3} ± {:.3}, seen at cosines from {least:.2} to {greatest:.2}",
        angle.exponent, angle.standard_error
    )
}

/// The materials, and what the windows know of each factor.
pub(super) fn report(report: &TargetReport) -> String {
    let heads = ["  recording", "label", "windows", "outliers", "own cos exponent", "use"];
    let mut rows = vec![heads.map(str::to_owned).to_vec()];
    rows.extend(report.surfaces.iter().map(|surface| {
        vec![
            format!("  {}", surface.recording),
            surface.label.to_string(),
            surface.windows.to_string(),
            surface.outliers.to_string(),
            surface.exponent.map_or_else(|| "-".to_owned(), |exponent| format!("{exponent:.2}")),
            if surface.left_out { "left out as glossy" } else { "fitted" }.to_owned(),
        ]
    }));
    let lambert = if report.lambert_assumed { ", Lambert's cosine assumed" } else { "" };
    format!(
        "\ntargets, all factors together: residual σ {:.2} %, rank {} of {} unknowns{lambert}\n{}\n{}",
        100.0 * report.sigma,
        report.rank,
        report.unknowns,
        table(&rows),
        findings(&report.findings)
    )
}
