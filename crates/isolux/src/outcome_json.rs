//! Figures as JSON, or the reason why a figure is missing.

use std::fmt::Display;

use serde::{Serialize, Serializer};

/// Serializes a figure as itself; a missing one as its reason, with the reason's text in the field `because`.
pub(crate) fn serialize<T: Serialize, E: Serialize + Display, S: Serializer>(
    figure: &Result<T, E>,
    serializer: S,
) -> Result<S::Ok, S::Error> {
    #[derive(Serialize)]
    struct Missing<'a, E> {
        #[serde(flatten)]
        reason: &'a E,
        because: String,
    }
    match figure {
        Ok(value) => value.serialize(serializer),
        Err(reason) => Missing { reason, because: reason.to_string() }.serialize(serializer),
    }
}
