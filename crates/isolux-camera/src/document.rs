//! Reading TOML so that every complaint names its line.

use serde::de::DeserializeOwned;
use toml::de::{DeTable, DeValue};

use crate::error::{CameraError, InvalidValue};

/// Version of the camera and scene formats that this program reads and writes.
pub(crate) const VERSION: i64 = 1;

/// Parses `text`, the content of the file called `document`.
///
/// The version is looked at first: a newer file would otherwise be refused for its first new field, which
/// sends the reader looking for a spelling mistake.
pub(crate) fn parse<T: DeserializeOwned>(document: &str, text: &str) -> Result<T, CameraError> {
    let refused = |error: &toml::de::Error| CameraError::Document {
        document: document.to_owned(),
        line: error.span().map_or(1, |span| line_of_byte(text, span.start)),
        message: error.message().replace('\n', ", "),
    };
    let table = DeTable::parse(text).map_err(|error| refused(&error))?;
    let version = table.get_ref().get("version").and_then(|value| value.get_ref().as_integer());
    if let Some(found) = version.and_then(|version| version.as_str().parse::<i64>().ok())
        && found > VERSION
    {
        return Err(CameraError::Version { document: document.to_owned(), found, supported: VERSION });
    }
    toml::from_str(text).map_err(|error| refused(&error))
}

/// Adds the file and the line of the field to a complaint about its value.
pub(crate) fn locate(document: &str, text: &str, invalid: InvalidValue) -> InvalidValue {
    let line = line_of_field(text, &invalid.field);
    InvalidValue { document: document.to_owned(), line, ..invalid }
}

/// Line of `path` (`object[2].texture.uniform`), or of the innermost table on the way that the text has.
fn line_of_field(text: &str, path: &str) -> Option<usize> {
    let document = DeTable::parse(text).ok()?;
    let mut line = None;
    let mut table = Some(document.get_ref());
    let mut array = None;
    for step in path.split(['.', '[']) {
        let value = match (step.strip_suffix(']'), table, array) {
            (Some(index), _, Some(values)) => element(values, index),
            (None, Some(table), _) => DeTable::get(table, step),
            _ => None,
        };
        let Some(value) = value else { break };
        line = Some(line_of_byte(text, value.span().start));
        (table, array) = (value.get_ref().as_table(), value.get_ref().as_array());
    }
    line
}

fn element<'a, 'i>(values: &'a toml::de::DeArray<'i>, index: &str) -> Option<&'a toml::Spanned<DeValue<'i>>> {
    values.get(index.parse::<usize>().ok()?)
}

fn line_of_byte(text: &str, byte: usize) -> usize {
    text.bytes().take(byte).filter(|&byte| byte == b'\n').count() + 1
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str =
        "name = 'x'\n\n[[object]]\na = 1\n[[object]]\ntexture = { uniform = 3 }\nlist = [1,\n 2]\n";

    #[test]
    fn fields_are_found_by_their_path() {
        assert_eq!(line_of_field(TEXT, "name"), Some(1));
        assert_eq!(line_of_field(TEXT, "object[0].a"), Some(4));
        assert_eq!(line_of_field(TEXT, "object[1].texture.uniform"), Some(6));
        assert_eq!(line_of_field(TEXT, "object[1].list[1]"), Some(8));
        assert_eq!(line_of_field(TEXT, "nowhere"), None);
        // A field that was left out is looked for at its table.
        assert_eq!(line_of_field(TEXT, "object[1].center_m"), Some(5));
    }
}
