//! One file per experiment; each makes a section of the page.

mod beyond;
mod competition;
mod distance;
mod exposure;
mod objects;
mod open_questions;
mod parts;
mod purpose;
mod scenes;
mod specular;

use isolux_report::page::Section;

use crate::error::PaperError;
use crate::lab::Lab;

/// Makes one section.
pub type Experiment = fn(&Lab) -> Result<Section, PaperError>;

/// Every experiment, in the order of the page, with what progress calls it.
pub const ALL: &[(&str, Experiment)] = &[
    ("figures 1 to 3", exposure::section),
    ("figures 4, 5 and 10", distance::section),
    ("figures 6 and 13", specular::section),
    ("figures 7 to 9", scenes::section),
    ("figures 11 and 12", objects::section),
    ("one set of parameters", purpose::section),
    ("rivals on the same frames", competition::section),
    ("beyond the paper", beyond::section),
    ("open questions", open_questions::section),
];
