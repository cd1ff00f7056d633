//! The experiments of Stürmer, Penne and Hornegger, "Standardization of Intensity-Values Acquired by
//! Time-of-Flight-Cameras" (2008), on the simulated SR-3100: every figure, what the paper states about it, what
//! is measured here, and whether it holds.
//!
//! [`Lab`] holds what the experiments share: the simulated sweeps and the calibration fitted on them. Each file of
//! [`figures`] makes one section of the [`page`](fn@page).

pub mod beyond;
mod error;
pub mod figures;
mod lab;
mod measure;
mod structure;

use isolux_report::page::Page;

pub use error::PaperError;
pub use lab::{BoardMean, Lab, RegionMeans, WallSweep};

/// Runs every experiment. `progress` is told what is being done.
///
/// The same seed gives the same page.
///
/// # Errors
/// [`PaperError`] when a simulation or a fit fails, which no seed should bring about.
pub fn page(seed: u64, progress: &mut dyn FnMut(&str)) -> Result<Page, PaperError> {
    let lab = Lab::new(seed, progress)?;
    let mut sections = Vec::new();
    for (name, section) in figures::ALL {
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
