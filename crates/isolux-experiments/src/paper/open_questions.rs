//! What the paper left open: how far a lookup table carries over to other light and other walls, and how much noise
//! the distance brings into the amplitude.

mod noise_port;
mod table_transfer;

use isolux_report::page::Section;

use crate::error::ExperimentError;
use crate::paper::lab::Lab;

/// The section of the open questions.
///
/// # Errors
/// [`ExperimentError`], which no seed should bring about.
pub(super) fn section(lab: &Lab) -> Result<Section, ExperimentError> {
    let mut blocks = table_transfer::blocks(lab)?;
    blocks.extend(noise_port::blocks(lab)?);
    Ok(Section { id: "open-questions".to_owned(), title: "What the paper left open".to_owned(), blocks })
}
