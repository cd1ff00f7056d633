//! `profile`: the illumination profile of lobe and lens, a gain of each pixel (beyond the paper):
//! `ln v(x, y) = c₁ r² + c₂ r⁴ + Σ c_kl B_k(x) B_l(y)`, `v(origin) = 1`; x and y from the principal point in units of the
//! half diagonal, B cubic B-splines on equal intervals, 8 along a row and 6 along a column.
//!
//! The profile is valid (supported) where the target was seen. A pixel elsewhere gets the value of the last
//! supported place on the line from the origin to the pixel, and is flagged.

mod gains;
mod map;
mod model;
mod places;
mod surface;
#[cfg(test)]
mod tests;

pub(crate) use gains::ProfileGains;
pub use map::Map;
pub use model::Profile;
pub use places::Places;
pub(crate) use surface::{RADIAL, Surface};
