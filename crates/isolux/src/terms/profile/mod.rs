//! `profile`: the illumination profile of lobe and lens, a gain of each pixel (beyond the paper):
//! `ln v(x, y) = c₁ r² + c₂ r⁴ + Σ c_kl B_k(x) B_l(y)`, `v(origin) = 1`.

mod places;
mod surface;

pub use places::Places;
pub(crate) use surface::{RADIAL, Surface};
