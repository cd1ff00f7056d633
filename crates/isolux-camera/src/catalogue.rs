//! Embedded files that are found by name.

use crate::error::CameraError;

/// Names and texts of one kind of file.
pub(crate) struct Catalogue {
    /// What is listed, in the singular, for errors.
    pub(crate) kind: &'static str,
    /// Name and text of each.
    pub(crate) entries: &'static [(&'static str, &'static str)],
}

impl Catalogue {
    pub(crate) fn names(&self) -> impl Iterator<Item = &'static str> + use<> {
        self.entries.iter().map(|(name, _)| *name)
    }

    pub(crate) fn text(&self, name: &str) -> Result<&'static str, CameraError> {
        let found = self.entries.iter().find(|(known, _)| *known == name);
        found.map(|(_, text)| *text).ok_or_else(|| CameraError::UnknownName {
            kind: self.kind,
            found: name.to_owned(),
            known: self.names().collect::<Vec<_>>().join(", "),
        })
    }
}
