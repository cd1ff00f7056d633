//! Range checks of parameters that are read from a calibration file, each with the path of its field.

use std::fmt::Display;

/// A range check that a versioned parameter set failed when read.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{field}: {found}; {expected} expected")]
pub struct ParameterError {
    /// Path of the field in the calibration file.
    pub field: String,
    /// The value found.
    pub found: String,
    /// What was expected.
    pub expected: &'static str,
}

/// A place in the calibration file whose value is checked.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Check<'a> {
    within: Option<&'a Check<'a>>,
    name: &'a str,
}

/// Parameters of the calibration file under a name of their own.
pub(crate) trait Parameters {
    /// Name in the calibration file.
    const NAME: &'static str;

    /// Refuses parameters that no fit gives; `here` is their place in the file.
    fn check_at(&self, here: &Check<'_>) -> Result<(), ParameterError>;
}

impl<'a> Check<'a> {
    /// A place at the top.
    pub(crate) fn of(name: &'a str) -> Self {
        Self { within: None, name }
    }

    /// A place within this one.
    pub(crate) fn at(&'a self, name: &'a str) -> Self {
        Self { within: Some(self), name }
    }

    /// Refuses what was `found` here unless it is `fine`.
    pub(crate) fn require(
        &self,
        fine: bool,
        found: impl Display,
        expected: &'static str,
    ) -> Result<(), ParameterError> {
        if fine {
            Ok(())
        } else {
            Err(ParameterError { field: self.path(), found: found.to_string(), expected })
        }
    }

    /// Refuses a set of parameters of another version.
    pub(crate) fn version(&self, found: u32, expected: u32) -> Result<(), ParameterError> {
        // Every set is at its first version.
        self.at("version").require(found == expected, found, "1")
    }

    /// Refuses `parameters` that no fit can have written, if there are any; they stand within this place.
    pub(crate) fn optional<P: Parameters>(&self, parameters: &Option<P>) -> Result<(), ParameterError> {
        parameters.as_ref().map_or(Ok(()), |parameters| parameters.check_at(&self.at(P::NAME)))
    }

    fn path(&self) -> String {
        self.within.map_or_else(|| self.name.to_owned(), |within| format!("{}.{}", within.path(), self.name))
    }
}

/// The same for parameters at the top of a calibration's terms.
pub(crate) fn optional_term<P: Parameters>(term: &Option<P>) -> Result<(), ParameterError> {
    term.as_ref().map_or(Ok(()), |term| term.check_at(&Check::of(P::NAME)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_refusal_tells_the_whole_path() {
        let response = Check::of("response");
        let error = response.at("pixel").at("softness").require(false, 0.5, "a softness from 1 to 16");
        assert_eq!(
            error.unwrap_err().to_string(),
            "response.pixel.softness: 0.5; a softness from 1 to 16 expected"
        );
        assert_eq!(response.version(1, 1), Ok(()));
        assert_eq!(response.version(2, 1).unwrap_err().field, "response.version");
    }
}
