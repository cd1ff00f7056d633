//! `recording.json`: what is known of a recording besides its arrays.

use std::fs;
use std::io::Read;
use std::path::Path;

use isolux::{Intrinsics, PhaseConvention};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use super::codes::Codes;
use super::distance_unit::DistanceUnit;
use super::frequency::ModulationFrequency;
use super::lens::{self, BadLens, LensDescription};
use crate::error::RecordingError;

/// More than any description of a recording takes; a larger file is something else.
const LONGEST_JSON_BYTES: u64 = 64 << 20;

/// What the field `codes` may hold.
const CODES: &str = "{\"amplitude\": {\"saturated\": .., \"too_dark\": .., \"invalid\": ..}, \"distance\": {..}}, each a value, \
     {\"from\": value} or a list of them";

/// What the distance channel measures.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum DistanceKind {
    /// From the pixel to the point.
    #[default]
    Radial,
    /// Along the optical axis; made radial on reading.
    Z,
}

/// Intrinsics as recorded, with whatever else stands beside them (distortion coefficients, say).
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RecordedIntrinsics {
    /// The pinhole part.
    #[serde(flatten)]
    pub pinhole: Intrinsics,
    /// Further fields, kept as they are.
    #[serde(flatten)]
    pub other: Map<String, Value>,
}

impl From<Intrinsics> for RecordedIntrinsics {
    fn from(pinhole: Intrinsics) -> Self {
        Self { pinhole, other: Map::new() }
    }
}

/// The contents of `recording.json`: every field optional, unknown ones kept.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct RecordingInfo {
    /// Name of the camera.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub camera: Option<String>,
    /// Modulation frequency in Hz, or two.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub modulation_frequency_hz: Option<ModulationFrequency>,
    /// What the distance channel measures; radial where it is not said.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub distance_kind: Option<DistanceKind>,
    /// Unit of the distance channel; where it is not said, metres for floats and millimetres for integers.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub distance_unit: Option<DistanceUnit>,
    /// Integration time of all frames in µs, where it is constant.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub integration_time_us: Option<f64>,
    /// Values of amplitude and distance that are no measurements.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub codes: Option<Codes>,
    /// The amplitude code that means saturated, DN; short for one of the `codes`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub saturated_amplitude: Option<f32>,
    /// The value at which a phase sample clips, DN.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub saturated_phase_sample: Option<f32>,
    /// Order and sign of the bins; the paper's where it is not said.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub phase_convention: Option<PhaseConvention>,
    /// Intrinsics of a camera; those of a lidar, beams, stay among the other fields. [`Self::lens`] reads both.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub intrinsics: Option<RecordedIntrinsics>,
    /// Every other field, kept as it is.
    #[serde(flatten)]
    pub other: Map<String, Value>,
}

impl RecordingInfo {
    /// Reads `path`; an absent file says nothing, which is fine.
    pub(crate) fn read_if_present(path: &Path) -> Result<Self, RecordingError> {
        match fs::metadata(path) {
            Ok(metadata) if !metadata.is_file() => {
                return Err(RecordingError::content(path, "a folder or device", "a file"));
            }
            Ok(_) => {}
            // A symbolic link that leads nowhere is not the same as no file.
            Err(_) if fs::symlink_metadata(path).is_err() => return Ok(Self::default()),
            Err(error) => return Err(RecordingError::io("open", path)(error)),
        }
        let file = fs::File::open(path).map_err(RecordingError::io("open", path))?;
        let mut bytes = Vec::new();
        file.take(LONGEST_JSON_BYTES + 1)
            .read_to_end(&mut bytes)
            .map_err(RecordingError::io("read", path))?;
        if bytes.len() as u64 > LONGEST_JSON_BYTES {
            let expected = format!("at most {LONGEST_JSON_BYTES} bytes that describe the recording");
            return Err(RecordingError::content(path, "a longer file", expected));
        }
        Self::from_json(&bytes, path)
    }

    /// The lens that the fields describe; nothing where they make none. A table of rays comes before it.
    #[must_use]
    pub fn lens(&self) -> LensDescription {
        self.read_lens().unwrap_or_default()
    }

    fn read_lens(&self) -> Result<LensDescription, BadLens> {
        let intrinsics = self.intrinsics.as_ref();
        lens::describe(intrinsics.map(|intrinsics| (intrinsics.pinhole, &intrinsics.other)), &self.other)
    }

    /// Parses the bytes of a `recording.json`. `path` is for messages.
    ///
    /// # Errors
    /// [`RecordingError::Json`] for what is not JSON, [`RecordingError::Content`] for JSON that is no object, and
    /// [`RecordingError::Info`] for a documented field whose value cannot be used.
    pub fn from_json(bytes: &[u8], path: &Path) -> Result<Self, RecordingError> {
        let value = serde_json::from_slice(bytes)
            .map_err(|source| RecordingError::Json { path: path.to_owned(), source })?;
        let Value::Object(mut fields) = value else {
            return Err(RecordingError::content(path, kind(&value), "a JSON object: {\"camera\": ..., ...}"));
        };
        let mut reader = Fields { path, fields: &mut fields };
        let info = Self {
            camera: reader.take("camera", "a string")?,
            modulation_frequency_hz: reader.take_frequency()?,
            distance_kind: reader.take("distance_kind", "\"radial\" or \"z\"")?,
            distance_unit: reader.take("distance_unit", DistanceUnit::EXPECTED)?,
            integration_time_us: reader.take_positive("integration_time_us")?,
            codes: reader.take("codes", CODES)?,
            saturated_amplitude: reader.take_positive("saturated_amplitude")?.map(|value| value as f32),
            saturated_phase_sample: reader.take_positive("saturated_phase_sample")?.map(|value| value as f32),
            phase_convention: reader.take_convention()?,
            intrinsics: reader.take_intrinsics()?,
            other: Map::new(),
        };
        let info = Self { other: fields, ..info };
        info.read_lens().map_err(|bad| RecordingError::info(path, &bad.field, &bad.found, &bad.expected))?;
        Ok(info)
    }

    /// The text of the file: fields in a fixed order, two spaces of indentation, a line feed at the end.
    pub(crate) fn to_json(&self, path: &Path) -> Result<String, RecordingError> {
        serde_json::to_string_pretty(self)
            .map(|text| text + "\n")
            .map_err(|source| RecordingError::Json { path: path.to_owned(), source })
    }
}

struct Fields<'a> {
    path: &'a Path,
    fields: &'a mut Map<String, Value>,
}

impl Fields<'_> {
    fn error(&self, field: &str, found: &Value, expected: &str) -> RecordingError {
        RecordingError::info(self.path, field, found, expected)
    }

    /// The field, or `None` where it is absent or null.
    fn take<T: DeserializeOwned>(
        &mut self,
        field: &str,
        expected: &str,
    ) -> Result<Option<T>, RecordingError> {
        let Some(value) = self.fields.remove(field) else { return Ok(None) };
        Option::deserialize(&value).map_err(|_| self.error(field, &value, expected))
    }

    fn take_positive(&mut self, field: &str) -> Result<Option<f64>, RecordingError> {
        let expected = "a positive number";
        let value: Option<f64> = self.take(field, expected)?;
        match value {
            Some(value) if !(value > 0.0 && value.is_finite()) => {
                Err(self.error(field, &value.into(), expected))
            }
            _ => Ok(value),
        }
    }

    fn take_frequency(&mut self) -> Result<Option<ModulationFrequency>, RecordingError> {
        let (field, expected) = (
            "modulation_frequency_hz",
            "a positive number, or two unlike ones, [first, second], whose common divisor is at least 1/64 of them",
        );
        let frequency: Option<ModulationFrequency> = self.take(field, expected)?;
        match frequency {
            Some(frequency) if !frequency.is_usable() => {
                let found = serde_json::to_value(frequency).unwrap_or_default();
                Err(self.error(field, &found, expected))
            }
            _ => Ok(frequency),
        }
    }

    fn take_convention(&mut self) -> Result<Option<PhaseConvention>, RecordingError> {
        let (field, expected) =
            ("phase_convention", "{\"order\": a permutation of [0, 1, 2, 3], \"reversed\": true or false}");
        let convention: Option<PhaseConvention> = self.take(field, expected)?;
        match convention {
            Some(convention) if !convention.is_permutation() => {
                Err(self.error(field, &format!("{:?}", convention.order).into(), expected))
            }
            _ => Ok(convention),
        }
    }

    fn take_intrinsics(&mut self) -> Result<Option<RecordedIntrinsics>, RecordingError> {
        let expected = "{fx, fy, cx, cy} in pixels, fx and fy positive";
        let Some(value) = self.fields.remove("intrinsics") else { return Ok(None) };
        if value.is_null() {
            return Ok(None);
        }
        if value.as_object().is_some_and(lens::is_beams) {
            // No pinhole: what they describe is found where they stand.
            self.fields.insert("intrinsics".to_owned(), value);
            return Ok(None);
        }
        let pinhole = Intrinsics::deserialize(&value).ok().filter(Intrinsics::is_usable);
        match (pinhole, value) {
            (Some(pinhole), Value::Object(mut other)) => {
                ["fx", "fy", "cx", "cy"].into_iter().for_each(|name| drop(other.remove(name)));
                Ok(Some(RecordedIntrinsics { pinhole, other }))
            }
            (_, value) => Err(self.error("intrinsics", &value, expected)),
        }
    }
}

fn kind(value: &Value) -> &'static str {
    match value {
        Value::Null => "null",
        Value::Bool(_) => "a boolean",
        Value::Number(_) => "a number",
        Value::String(_) => "a string",
        Value::Array(_) => "an array",
        Value::Object(_) => "an object",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str) -> Result<RecordingInfo, RecordingError> {
        RecordingInfo::from_json(text.as_bytes(), Path::new("recording.json"))
    }

    #[test]
    fn unknown_fields_survive_a_round_trip() {
        let text = r#"{"camera": "X", "distance_unit": "mm", "saturated_amplitude": 65535, "lens": {"name": "L"},
            "intrinsics": {"fx": 2, "fy": 2.5, "cx": 1, "cy": 0, "k1": -0.25}, "integration_time_us": null}"#;
        let info = parse(text).unwrap();
        assert_eq!(info.distance_unit, Some(DistanceUnit::Millimetre));
        assert_eq!(info.other["lens"]["name"], "L");
        assert_eq!(info.intrinsics.as_ref().unwrap().other["k1"], -0.25);
        assert_eq!(info.integration_time_us, None);
        assert_eq!(parse(&info.to_json(Path::new("out")).unwrap()).unwrap(), info);
    }

    #[test]
    fn fields_that_cannot_be_used_are_named() {
        let cases = [
            (r#"{"camera": 3}"#, "field `camera`: found 3, expected a string"),
            (r#"{"distance_kind": "depth"}"#, "field `distance_kind`: found \"depth\""),
            (r#"{"distance_unit": "cm"}"#, "field `distance_unit`: found \"cm\""),
            (r#"{"integration_time_us": 0}"#, "field `integration_time_us`: found 0.0, expected a positive"),
            (r#"{"modulation_frequency_hz": -2e7}"#, "field `modulation_frequency_hz`: found -20000000.0"),
            (r#"{"saturated_amplitude": "max"}"#, "field `saturated_amplitude`"),
            (r#"{"intrinsics": {"fx": 0, "fy": 1, "cx": 0, "cy": 0}}"#, "field `intrinsics`"),
            (r#"{"intrinsics": {"fx": 1, "fy": 1, "cx": 0}}"#, "field `intrinsics`"),
            (r#"{"intrinsics": [1, 1, 0, 0]}"#, "field `intrinsics`"),
            (r#"{"phase_convention": {"order": [0, 1, 1, 3]}}"#, "field `phase_convention`"),
            (r#"{"phase_convention": {"sign": 1}}"#, "field `phase_convention`"),
            ("[1, 2]", "found an array, expected a JSON object"),
            ("\"text\"", "found a string"),
            ("{\"fx\": NaN}", "not valid JSON"),
            ("", "not valid JSON"),
        ];
        for (text, expected) in cases {
            let message = parse(text).unwrap_err().to_string();
            assert!(
                message.starts_with("`recording.json`") && message.contains(expected),
                "{text}: {message}"
            );
        }
    }

    #[test]
    fn deep_nesting_is_refused_not_followed() {
        assert!(matches!(parse(&"[".repeat(100_000)), Err(RecordingError::Json { .. })));
    }
}
