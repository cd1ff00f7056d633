//! Numbers without images: statistics, fits and searches that know nothing of cameras.

pub(crate) mod bspline;
pub(crate) mod differences;
pub(crate) mod hash;
pub(crate) mod minimum;
pub(crate) mod quantile;
pub(crate) mod regression;
pub mod statistics;
