//! The unit of stored distances.

use serde::{Deserialize, Serialize};

use super::element::ElementType;

/// Unit of the distance channel. In `recording.json`: `"m"`, `"mm"`, or the metres of one unit as a number.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Written", into = "Written")]
pub enum DistanceUnit {
    /// Metres.
    Metre,
    /// Millimetres.
    Millimetre,
    /// Any other unit: metres for one of it, positive and finite. 0.00025 for steps of a quarter of a millimetre.
    Metres(f64),
}

/// As it is written.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[serde(untagged)]
enum Written {
    Name(Name),
    Metres(f64),
}

#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
enum Name {
    #[serde(rename = "m")]
    Metre,
    #[serde(rename = "mm")]
    Millimetre,
}

impl DistanceUnit {
    /// What may stand in `recording.json`.
    pub(crate) const EXPECTED: &str =
        "\"m\", \"mm\", or the metres of one unit as a number (0.01 for centimetres)";

    /// That of distances of this type, where the recording states none: integers are millimetres and floats metres, as
    /// in REP 118.
    #[must_use]
    pub fn usual(element: ElementType) -> Self {
        if element.is_integer() { Self::Millimetre } else { Self::Metre }
    }

    /// Metres for one unit.
    #[must_use]
    pub fn metres(self) -> f64 {
        match self {
            Self::Metre => 1.0,
            Self::Millimetre => 0.001,
            Self::Metres(metres) => metres,
        }
    }

    /// Makes a stored value metric, with one rounding.
    pub(crate) fn to_metres(self, value: f32) -> f32 {
        match self {
            Self::Metre => value,
            // A division, not a product with 0.001, which is none.
            Self::Millimetre => value / 1000.0,
            Self::Metres(metres) => (f64::from(value) * metres) as f32,
        }
    }
}

impl TryFrom<Written> for DistanceUnit {
    type Error = &'static str;

    fn try_from(written: Written) -> Result<Self, Self::Error> {
        match written {
            Written::Name(Name::Metre) => Ok(Self::Metre),
            Written::Name(Name::Millimetre) => Ok(Self::Millimetre),
            Written::Metres(metres) if metres > 0.0 && metres.is_finite() => Ok(Self::Metres(metres)),
            Written::Metres(_) => Err(Self::EXPECTED),
        }
    }
}

impl From<DistanceUnit> for Written {
    fn from(unit: DistanceUnit) -> Self {
        match unit {
            DistanceUnit::Metre => Self::Name(Name::Metre),
            DistanceUnit::Millimetre => Self::Name(Name::Millimetre),
            DistanceUnit::Metres(metres) => Self::Metres(metres),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_are_written_as_they_are_read() {
        for text in ["\"m\"", "\"mm\"", "0.00025"] {
            let unit: DistanceUnit = serde_json::from_str(text).unwrap();
            assert_eq!(serde_json::to_string(&unit).unwrap(), text);
        }
        for text in ["\"cm\"", "0", "-1.0", "[1]", "true"] {
            assert!(serde_json::from_str::<DistanceUnit>(text).is_err(), "{text}");
        }
        assert_eq!(DistanceUnit::Metres(0.00025).to_metres(4001.0), 1.00025);
    }
}
