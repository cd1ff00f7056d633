//! What a user can do about an error or a remark, in the options of this program.

use std::fmt::Display;

use isolux::standardize::{DistanceStep, TimeStep};
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
        Advice::UseTimeStep(step) => format!("use --time {}", time_name(*step)),
        Advice::UseDistanceStep(step) => format!("use --distance {}", distance_name(*step)),
        Advice::GiveNoise => "give the noise with --read-noise-dn and --shot-noise-dn2-per-dn".to_owned(),
        Advice::GiveOrEstimateNoise => {
            "give the noise (--read-noise-dn, --shot-noise-dn2-per-dn), a calibration that \
                                        holds it, or --sigma on to estimate it from the recording"
                .to_owned()
        }
        Advice::GiveBracketLength => "say how many frames a bracket has, --merge-bracket=N".to_owned(),
        Advice::NameCamera => "say which with --camera NAME".to_owned(),
        Advice::LeaveInputOut => "leave out --keep-input".to_owned(),
        Advice::RecordCalibratedTimes => {
            "record within it, calibrate further, or use --time linear".to_owned()
        }
        Advice::GiveIntrinsics => "add \"intrinsics\" to recording.json".to_owned(),
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

fn time_name(step: TimeStep) -> String {
    format!("{step:?}").to_lowercase()
}

fn distance_name(step: DistanceStep) -> String {
    format!("{step:?}").to_lowercase()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_advice_follows_what_was_found() {
        assert_eq!(
            with("too dark", Some(Advice::UseTimeStep(TimeStep::Linear))),
            "too dark: use --time linear"
        );
        assert_eq!(with("too dark", None), "too dark");
    }
}
