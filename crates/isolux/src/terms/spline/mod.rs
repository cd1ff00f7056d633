//! `spline`: a smooth law over distance around the inverse square, in logarithms (beyond the paper):
//! `ln h(d) = −2 ln(d/d_ref) + Σ c_k B_k(ln d) + w_c cos 4φ + w_s sin 4φ`, `φ = 4π f d / c`.
//!
//! The B-splines take up what a light source of finite size adds to the inverse square (or what a vendor has taken
//! from it); the harmonic is the aliased third one of the modulation (`A (1 + h₃ cos 4φ)`), known once the
//! modulation frequency is. Outside the fitted distances h goes on with the slope −2.

mod error;
mod fit;
mod harmonic;
mod law;
mod least_squares;
mod model;
mod select;
#[cfg(test)]
mod tests;

pub use error::SplineError;
pub use fit::SplineUse;
pub use harmonic::Harmonic;
pub use law::Law;
pub use model::Spline;
