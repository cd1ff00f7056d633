//! Numerical methods that do not depend on cameras: statistics, fits and searches.

pub(crate) mod bit_histogram;
pub(crate) mod bspline;
pub(crate) mod differences;
pub(crate) mod hash;
pub(crate) mod minimum;
pub(crate) mod nnls;
pub(crate) mod nonlinear;
pub(crate) mod plane_fit;
pub(crate) mod quantile;
pub(crate) mod regression;
pub(crate) mod robust;
pub mod statistics;
