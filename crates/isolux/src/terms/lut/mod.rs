//! `lut`: the paper's lookup table over integration time (section 2.1, eq. 4): one scalar per time, the inverse
//! of the mean amplitude of the whole image, 1 at the reference time.

mod error;
mod fit;
mod model;
mod sample;
#[cfg(test)]
mod tests;

pub use error::LutError;
pub use model::{Lut, LutAnswer};
pub use sample::{ExposureSample, RelativeSample};
