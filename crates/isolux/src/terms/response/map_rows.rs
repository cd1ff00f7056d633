//! A map as one string per image row: a person can read it, and it takes a third of the lines and bytes of a list.

use serde::de::Error;
use serde::{Deserialize, Deserializer, Serializer};

type Map = Vec<Vec<Option<f32>>>;

pub(super) fn serialize<S: Serializer>(map: &Map, serializer: S) -> Result<S::Ok, S::Error> {
    let word = |value: &Option<f32>| value.map_or_else(|| "-".to_owned(), |value| value.to_string());
    serializer.collect_seq(map.iter().map(|row| row.iter().map(word).collect::<Vec<_>>().join(" ")))
}

pub(super) fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Map, D::Error> {
    let value = |word: &str| match word {
        "-" => Ok(None),
        number => number
            .parse()
            .map(Some)
            .map_err(|_| D::Error::custom(format!("`{number}` in a row of a map; a number or `-` expected"))),
    };
    let rows = Vec::<String>::deserialize(deserializer)?;
    rows.iter().map(|row| row.split_ascii_whitespace().map(value).collect()).collect()
}
