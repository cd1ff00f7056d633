//! What the fit of ordinary recordings found, in words and tables.

use isolux::calibrate::scene::SceneUse;
use isolux::calibrate::{MotionFinding, SceneReport};

use super::findings::findings;
use crate::terminal::table;

/// The recordings, and what they know of each factor.
pub(super) fn report(report: &SceneReport) -> String {
    let mut rows = vec![["  recording", "observations", "camera"].map(str::to_owned).to_vec()];
    rows.extend(
        report.scenes.iter().map(|scene| {
            vec![format!("  {}", scene.recording), scene.observations.to_string(), motion(scene)]
        }),
    );
    let recordings = table(&rows);
    if report.observations == 0 {
        return format!("\nscenes: nothing fitted\n{recordings}");
    }
    let percent = |value: f64| format!("{:.2} %", 100.0 * value);
    format!(
        "\nscenes, all factors together: {} observations of {} surfaces, residual σ {}, held out {}, outliers {}, rank {} \
         of {} unknowns\n{recordings}\n{}",
        report.observations,
        report.surfaces,
        percent(report.sigma),
        report.held_out_residual.map_or_else(|| "not determined".to_owned(), percent),
        percent(report.outlier_share),
        report.rank,
        report.unknowns,
        findings(&report.findings)
    )
}

fn motion(scene: &SceneUse) -> String {
    match &scene.motion {
        MotionFinding::Still => "still".to_owned(),
        MotionFinding::Recorded(travel) => {
            format!("poses recorded: up to {:.2} m and {:.0}° away", travel.away_m, travel.turned_deg)
        }
        MotionFinding::Estimated { travel, frames_lost, residual } => format!(
            "motion estimated: up to {:.2} m and {:.0}° away, residual {residual:.2}σ, {frames_lost} frames lost",
            travel.away_m, travel.turned_deg
        ),
        _ => "motion not told".to_owned(),
    }
}
