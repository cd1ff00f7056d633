//! Experiments, most of them on the simulated camera: what the standardized amplitudes are worth, in figures.
//!
//! [`paper`] repeats every experiment of Stürmer, Penne and Hornegger (2008), section by section of one page.
//! [`unseen`] measures what the terms that the paper does not have reach on cameras and frames, simulated and real, that
//! nothing was fitted or tuned on.

mod error;
mod measure;
pub mod paper;
mod structure;
pub mod unseen;

pub use error::ExperimentError;
