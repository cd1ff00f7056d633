//! The experiments of Stürmer, Penne and Hornegger, "Standardization of Intensity-Values Acquired by
//! Time-of-Flight-Cameras" (2008), on the simulated SR-3100: every figure, what the paper states about it, what
//! is measured here, and whether it holds.
//!
//! [`Lab`] holds what the experiments share: the simulated sweeps and the calibration fitted on them. Each file makes
//! one section of the [`page`](fn@page).

mod competition;
mod distance;
mod exposure;
mod lab;
mod objects;
mod open_questions;
mod parts;
mod purpose;
mod scenes;
mod specular;
mod unseen_cameras;

use isolux_report::page::{Page, Section};

use crate::error::ExperimentError;

pub use lab::{BoardMean, Lab, RegionMeans, WallSweep};

/// Makes one section.
pub type Experiment = fn(&Lab) -> Result<Section, ExperimentError>;

/// Every experiment, in the order of the page, with what progress calls it.
pub const ALL: &[(&str, Experiment)] = &[
    ("figures 1 to 3", exposure::section),
    ("figures 4, 5 and 10", distance::section),
    ("figures 6 and 13", specular::section),
    ("figures 7 to 9", scenes::section),
    ("figures 11 and 12", objects::section),
    ("one set of parameters", purpose::section),
    ("rivals on the same frames", competition::section),
    ("beyond the paper", unseen_cameras::section),
    ("open questions", open_questions::section),
];

/// Runs every experiment. `progress` is told what is being done.
///
/// The same seed gives the same page.
///
/// # Errors
/// [`ExperimentError`] when a simulation or a fit fails, which no seed should bring about.
pub fn page(seed: u64, progress: &mut dyn FnMut(&str)) -> Result<Page, ExperimentError> {
    let lab = Lab::new(seed, progress)?;
    let mut sections = Vec::new();
    for (name, section) in ALL {
        progress(name);
        sections.push(section(&lab)?);
    }
    Ok(Page {
        title: "Standardization of ToF amplitude images: the paper's experiments, repeated".to_owned(),
        lead: "Every experiment of Stürmer, Penne and Hornegger (2008) on a simulated SR-3100: what the paper states, \
               what is measured here, and whether it holds."
            .to_owned(),
        sections,
        colophon: format!(
            "Made by isolux {} with `isolux paper --seed {seed}`. All data are simulated.",
            env!("CARGO_PKG_VERSION")
        ),
    })
}
