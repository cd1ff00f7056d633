//! Codes: values of a channel that are no measurements, and what they mean.

use isolux::PixelFlags;
use serde::{Deserialize, Serialize};

/// The codes of a recording, as its `recording.json` names them:
///
/// ```json
/// {"codes": {"amplitude": {"saturated": 65535, "too_dark": [0, 1]}, "distance": {"invalid": {"from": 4090}}}}
/// ```
///
/// All values are those that are stored, before any unit is applied.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Codes {
    /// Of the amplitudes. Whatever a code means, the pixel is INVALID.
    #[serde(skip_serializing_if = "ChannelCodes::is_empty")]
    pub amplitude: ChannelCodes,
    /// Of the distances. Whatever a code means, the pixel has no distance.
    #[serde(skip_serializing_if = "ChannelCodes::is_empty")]
    pub distance: ChannelCodes,
}

/// The codes of one channel by their meaning.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ChannelCodes {
    /// Too much light; the pixel is SATURATED.
    #[serde(skip_serializing_if = "OneOrMore::is_empty")]
    pub saturated: OneOrMore,
    /// Too little light; the pixel is LOW_SIGNAL.
    #[serde(skip_serializing_if = "OneOrMore::is_empty")]
    pub too_dark: OneOrMore,
    /// Any other reason.
    #[serde(skip_serializing_if = "OneOrMore::is_empty")]
    pub invalid: OneOrMore,
}

/// Codes of one meaning. A single one may be written without brackets.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum OneOrMore {
    /// One code.
    One(Code),
    /// Any number of codes.
    More(Vec<Code>),
}

/// A code.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Code {
    /// This value.
    Exactly(f64),
    /// All values that are not below this one.
    From(CodesFrom),
}

/// The smallest of a range of codes without an end.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CodesFrom {
    /// The smallest code.
    pub from: f64,
}

impl Default for OneOrMore {
    fn default() -> Self {
        Self::More(Vec::new())
    }
}

impl OneOrMore {
    fn codes(&self) -> &[Code] {
        match self {
            Self::One(code) => std::slice::from_ref(code),
            Self::More(codes) => codes,
        }
    }

    fn is_empty(&self) -> bool {
        self.codes().is_empty()
    }
}

impl Code {
    /// `value` in the precision in which channels are read.
    fn is(self, value: f32) -> bool {
        match self {
            Self::Exactly(code) => value == code as f32,
            Self::From(CodesFrom { from }) => value >= from as f32,
        }
    }
}

impl ChannelCodes {
    /// True where no value is a code.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.by_flag().iter().all(|(codes, _)| codes.is_empty())
    }

    /// What a stored value means beside "no measurement": a flag, or none. `None` where it is no code.
    #[must_use]
    pub fn meaning(&self, value: f32) -> Option<PixelFlags> {
        let found =
            self.by_flag().into_iter().find(|(codes, _)| codes.codes().iter().any(|code| code.is(value)));
        found.map(|(_, flag)| flag)
    }

    fn by_flag(&self) -> [(&OneOrMore, PixelFlags); 3] {
        [
            (&self.saturated, PixelFlags::SATURATED),
            (&self.too_dark, PixelFlags::LOW_SIGNAL),
            (&self.invalid, PixelFlags::empty()),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn codes(json: &str) -> serde_json::Result<Codes> {
        serde_json::from_str(json)
    }

    #[test]
    fn a_code_is_a_value_or_all_from_one_on_and_stands_alone_or_in_a_list() {
        let text = r#"{"amplitude":{"saturated":65535.0,"too_dark":[0.0,1.0]},"distance":{"invalid":{"from":4090.0}}}"#;
        let found = codes(text).unwrap();
        let meanings = [65535.0, 0.0, 1.0, 2.0].map(|value| found.amplitude.meaning(value));
        let (saturated, dark) = (Some(PixelFlags::SATURATED), Some(PixelFlags::LOW_SIGNAL));
        assert_eq!(meanings, [saturated, dark, dark, None]);
        let meanings = [4089.0, 4090.0, 70000.0].map(|value| found.distance.meaning(value));
        assert_eq!(meanings, [None, Some(PixelFlags::empty()), Some(PixelFlags::empty())]);
        assert_eq!(serde_json::to_string(&found).unwrap(), text);
    }

    #[test]
    fn what_is_no_code_is_refused() {
        for text in [
            r#"{"intensity": {}}"#,
            r#"{"amplitude": {"hot": 3}}"#,
            r#"{"distance": {"invalid": {"to": 3}}}"#,
            r#"{"distance": {"invalid": "4095"}}"#,
        ] {
            assert!(codes(text).is_err(), "{text}");
        }
    }
}
