//! Robust linear regression with intercepts per group and errors that may be shared within clusters.
//!
//! The model is `y_i = α_g(i) + Σ_k β_k x_ik + ε_i`. The intercepts α of the groups (one material, one pixel) are
//! eliminated, not solved for: there may be as many as there are pixels. ε may be correlated within a cluster
//! (neighbouring pixels, one frame); the intervals allow for that.

mod centred;
mod cluster;
mod error;
mod fit;
mod rank;
mod rows;
mod solve;
#[cfg(test)]
mod tests;

pub(crate) use error::RegressionError;
pub(crate) use fit::{Coefficient, RegressionFit};
pub(crate) use rows::{Intercepts, Regression, Row};
