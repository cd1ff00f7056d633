//! What a user can do about an error or a warning, in the options of this program.

use std::fmt::Display;

use isolux::{Advice, RecordingKind};

/// A finding, with what can be done about it.
pub(crate) fn with(finding: impl Display, advice: Option<Advice>) -> String {
    match advice.as_ref().map(words) {
        Some(words) if !words.is_empty() => format!("{finding}: {words}"),
        _ => finding.to_string(),
    }
}

/// The words of an advice; empty where this program has no option for it.
pub(crate) fn words(advice: &Advice) -> String {
    match advice {
        Advice::CalibrateFrom(kind) => format!("calibrate with {} REC", recording_option(*kind)),
        Advice::UseTimeStep(step) => format!("use --time {}", format!("{step:?}").to_lowercase()),
        Advice::UseDistanceStep(step) => format!("use --distance {}", format!("{step:?}").to_lowercase()),
        Advice::GiveNoise => "give the noise with --read-noise-dn and --shot-noise-dn2-per-dn".to_owned(),
        Advice::GiveIntrinsics => {
            "add \"intrinsics\": {\"fx\": .., \"fy\": .., \"cx\": .., \"cy\": ..} to recording.json"
                .to_owned()
        }
        Advice::GiveModulationFrequency => "give it with --modulation-frequency-hz".to_owned(),
        Advice::SkipFrames => "drop the first ones with --skip-frames".to_owned(),
        Advice::ExcludeTime { integration_time_us } => format!("use --exclude-time-us {integration_time_us}"),
        Advice::ReferenceTime { integration_time_us } => {
            format!("use --reference-time-us {}", number(*integration_time_us))
        }
        Advice::ReferenceDistance { distance_m } => {
            format!("use --reference-distance-m {}", number(*distance_m))
        }
        Advice::Window => "use another --window".to_owned(),
        _ => String::new(),
    }
}

fn number(value: Option<f64>) -> String {
    value.map_or_else(|| "X".to_owned(), |value| value.to_string())
}

fn recording_option(kind: RecordingKind) -> &'static str {
    match kind {
        RecordingKind::ExposureSweep => "--exposure-sweep",
        RecordingKind::DistanceSweep => "--distance-sweep",
        RecordingKind::Target => "--target",
        RecordingKind::Scene => "--scene",
    }
}
