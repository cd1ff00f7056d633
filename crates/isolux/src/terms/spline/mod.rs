//! `spline`: a smooth law over distance around the inverse square, in logarithms (beyond the paper):
//! `ln h(d) = −2 ln(d/d_ref) + Σ c_k B_k(ln d) + w_c cos 4φ + w_s sin 4φ`, `φ = 4π f d / c`.
//!
//! The B-splines describe the deviation from the inverse square, caused by a light source of finite size or by the
//! vendor's own correction. The harmonic is the aliased third harmonic of the modulation (`A (1 + h₃ cos 4φ)`); it
//! needs the modulation frequency. Outside the fitted distances, h continues with the slope −2.

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
