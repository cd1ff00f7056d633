//! What a user can do about an error or a remark, in the options of this program.

use std::fmt::Display;

use isolux::{Advice, PhaseConvention, RecordingField, RecordingKind};

/// A finding, with what can be done about it.
pub(crate) fn with(finding: impl Display, advice: Option<Advice>) -> String {
    match advice.as_ref().map(words) {
        Some(words) if !words.is_empty() => format!("{finding}: {words}"),
        _ => finding.to_string(),
    }
}

/// The words of an advice; empty where this program has none for it.
fn words(advice: &Advice) -> String {
    let fixed = match advice {
        Advice::UseTimeStep(step) => return format!("use --time {step}"),
        Advice::UseDistanceStep(step) => return format!("use --distance {step}"),
        Advice::CalibrateFrom(kind) => {
            return format!("fit it with `isolux calibrate {} REC`", recording_option(*kind));
        }
        Advice::ExcludeTime { integration_time_us } => {
            return format!("leave it out with --exclude-time-us {integration_time_us}");
        }
        Advice::ReferenceTime { integration_time_us } => {
            return setting("--reference-time-us", *integration_time_us);
        }
        Advice::ReferenceDistance { distance_m } => {
            return setting("--reference-distance-m", *distance_m);
        }
        Advice::WriteField(field) => return self::field(field),
        Advice::Calibrate => "`isolux calibrate` measures them",
        Advice::GiveNoise => {
            "give it with --read-noise-dn and --shot-noise-dn2-per-dn, or fit it with \
             `isolux calibrate --exposure-sweep REC`, several frames at each time"
        }
        Advice::GiveOrEstimateNoise => {
            "give the noise (--read-noise-dn, --shot-noise-dn2-per-dn), a calibration that holds it, or --sigma on to \
             estimate it from the recording"
        }
        Advice::GiveBracketLength => "say how many frames a bracket has, --merge-bracket=N",
        Advice::NameCamera => "say which with --camera NAME",
        Advice::LeaveInputOut => "leave out --keep-input",
        Advice::RecordCalibratedTimes => "record within it, calibrate further, or use --time linear",
        Advice::GiveIntrinsics => {
            "write {\"intrinsics\": {\"fx\": .., \"fy\": .., \"cx\": .., \"cy\": ..}} (pixels) into its recording.json, \
             or a table of rays into rays.npy (height, width, 3)"
        }
        Advice::GiveModulationFrequency => "give it with --modulation-frequency-hz",
        Advice::TakeOriginal => "take the recording that it was made from",
        Advice::Diagnose => "see `isolux diagnose`",
        Advice::RecordBrighter => "record with longer integration times or nearer",
        Advice::SkipFrames => "drop the first ones with --skip-frames",
        Advice::Window => "use another --window",
        Advice::AcceptPoorFit => "record again, or take it as it is with --accept-poor-fit",
        Advice::RecordUnscaledValues => {
            "record the values as the camera delivers them, such as its 16 bits, not images that were stretched for viewing"
        }
        Advice::RecordTimes => {
            "record `integration_time_us` with each frame, or fix the exposure; --time relative takes the factor out of what \
             stands still"
        }
        _ => "",
    };
    fixed.to_owned()
}

/// What to write into `recording.json`.
fn field(field: &RecordingField) -> String {
    let json = match field {
        RecordingField::SaturatedAmplitude { value_dn } => format!("\"saturated_amplitude\": {value_dn}"),
        RecordingField::InvalidDistance { value } => {
            format!("\"codes\": {{\"distance\": {{\"invalid\": {value}}}}}")
        }
        RecordingField::DistanceUnit { metres } => match metres {
            1.0 => "\"distance_unit\": \"m\"".to_owned(),
            0.001 => "\"distance_unit\": \"mm\"".to_owned(),
            metres => format!("\"distance_unit\": {metres}"),
        },
        RecordingField::TimesInMicroseconds { factor } => {
            return format!("multiply integration_time_us by {factor}");
        }
        RecordingField::ModulationFrequency => {
            return "correct \"modulation_frequency_hz\" or \"distance_unit\" in its recording.json"
                .to_owned();
        }
        RecordingField::Intrinsics => {
            return "scale \"intrinsics\" in its recording.json to the size of the frames".to_owned();
        }
        RecordingField::SaturatedPhaseSample { value_dn } => {
            format!("\"saturated_phase_sample\": {value_dn}")
        }
        RecordingField::PhaseConvention(PhaseConvention { order, reversed }) => {
            format!("\"phase_convention\": {{\"order\": {order:?}, \"reversed\": {reversed}}}")
        }
        RecordingField::IntegrationTime => "\"integration_time_us\": its value in µs".to_owned(),
        _ => return String::new(),
    };
    format!("write {json} into its recording.json")
}

fn setting(option: &str, value: Option<f64>) -> String {
    value.map_or_else(|| format!("{option} sets it"), |value| format!("use {option} {value}"))
}

fn recording_option(kind: RecordingKind) -> &'static str {
    match kind {
        RecordingKind::ExposureSweep => "--exposure-sweep",
        RecordingKind::DistanceSweep => "--distance-sweep",
        RecordingKind::Target => "--target",
        RecordingKind::Scene => "--scene",
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use isolux::standardize::TimeStep;

    #[test]
    fn an_advice_follows_what_was_found() {
        let advised = with("too dark", Some(Advice::UseTimeStep(TimeStep::Linear)));
        assert_eq!(advised, "too dark: use --time linear");
        assert_eq!(with("too dark", None), "too dark");
    }
}
