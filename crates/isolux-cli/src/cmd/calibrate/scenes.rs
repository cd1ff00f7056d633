//! Ordinary recordings: measured twice over, and what their fit found in words and tables.

use std::path::Path;

use isolux::Channels;
use isolux::calibrate::scene::SceneUse;
use isolux::calibrate::{
    CalibrateSettings, MotionFinding, MotionScout, SceneObservations, SceneReport, SceneSweep,
};
use isolux::terms::Response;

use super::RESPONSE_CHANNELS;
use super::findings::findings;
use super::linear::Linear;
use crate::advice;
use crate::console::table;
use crate::failure::{Failure, Outcome};
use crate::frames;

/// Looks at the recording once to learn where its poses come from, then measures it.
pub(super) fn observations(
    path: &Path,
    settings: &CalibrateSettings,
    response: Option<&Response>,
    cameras: &mut Vec<String>,
) -> Outcome<SceneObservations> {
    let mut recording = isolux_io::open(path)?;
    cameras.extend(recording.metadata().info.camera.clone());
    let mut linear = Linear::new(path, response)?;
    // Without a response, a still scene may tell it.
    let besides = if linear.is_possible() { linear.channels() } else { RESPONSE_CHANNELS };
    let wanted = Channels::AMPLITUDE | Channels::DISTANCE | Channels::INTEGRATION_TIME | Channels::POSE;
    let mut scout = MotionScout::default();
    frames::for_each(&mut *recording, wanted, "scene, first look", |_, frame| {
        scout.push(frame);
        Ok(())
    })?;
    let intrinsics = frames::stream(recording.metadata()).intrinsics;
    let mut sweep = SceneSweep::new(path.display().to_string(), settings, intrinsics, scout.verdict());
    frames::for_each(&mut *recording, wanted | besides, "scene", |_, frame| {
        let pushed = linear.frame(frame).and_then(|frame| sweep.push(frame));
        pushed.map_err(|error| {
            let found = format!("`{}`: {error}", path.display());
            Failure::data(advice::with(found, error.advice()))
        })
    })?;
    Ok(sweep.finish())
}

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
