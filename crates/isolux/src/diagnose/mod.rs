//! Is a stream of amplitudes still what the sensor measured, or has something upstream already corrected, bent or
//! clipped it? And what does the vendor's own scaling do?
//!
//! What the sensor measures grows with the integration time t as t¹, falls with the distance d of one material as
//! d⁻², and towards the corners with the illumination profile. A [`Diagnoser`] looks at frames one by one, keeps
//! a sample of bounded size, and [`Diagnoser::finish`] regresses ln A on ln t, ln d and r² (methods, section 8).
//! r is the distance from the principal point in units of the image's half diagonal.
//!
//! Each exponent comes from data that determine it, and from no other:
//!
//! | exponent | from |
//! |---|---|
//! | t | the same pixels of a still scene at several times; else one target label at several times |
//! | d | one target label at several distances; else pixels of one vendor amplitude, if that is a reflectivity |
//! | all, of the vendor's scaling | ln(vendor/raw): the material cancels |
//! | all, of the amplitude against its own phase samples | ln(amplitude / eq. 1) |
//!
//! What a recording does not determine is [`Unavailable`], with the reason.
//!
//! Intervals are 95 %, from sandwich errors clustered by image block (8×8 blocks) and, where there are at least
//! eight of them, by frame or integration time: neighbouring pixels and pixels of one frame are no independent
//! witnesses. They hold what repeats of such a recording would give, not errors of the model.
//!
//! ```
//! use isolux::diagnose::{Diagnoser, DiagnoseSettings, State};
//! use isolux::{Frame, IntegrationTime, Plane, Shape};
//!
//! let shape = Shape::new(32, 32);
//! let mut diagnoser = Diagnoser::new(shape, DiagnoseSettings::default());
//! for time_us in [500.0, 1000.0, 2000.0, 4000.0] {
//!     let mut frame = Frame::new(shape);
//!     let scene = |row: usize, column: usize| (100 + 7 * row + 3 * column) as f32;
//!     frame.amplitude = Plane::from_fn(shape, |row, column| time_us as f32 / 1000.0 * scene(row, column));
//!     frame.integration_time_us = IntegrationTime::PerFrame(time_us);
//!     frame.flag_amplitude(None);
//!     diagnoser.push(&frame)?;
//! }
//! let diagnosis = diagnoser.finish();
//! assert!(diagnosis.time.is_ok_and(|time| time.state == State::Present));
//! assert!(diagnosis.distance.is_err()); // There is no distance channel.
//! # Ok::<(), isolux::ShapeError>(())
//! ```

mod columns;
mod conclude;
mod diagnoser;
mod diagnosis;
mod effect;
mod finding;
mod limits;
mod material;
mod panel;
mod ranges;
mod rules;
mod sample;
mod scaling;
mod still;
#[cfg(test)]
mod tests;
mod unavailable;
mod values;
mod vendor;

pub use diagnoser::{DiagnoseSettings, Diagnoser};
pub use diagnosis::Diagnosis;
pub use effect::{Effect, Estimate, Evidence, State};
pub use finding::Finding;
pub use material::{Material, MaterialFit};
pub use ranges::RangeExponent;
pub use scaling::{RadialTerm, Scaling, TimeGroup};
pub use still::{Band, StillPixels};
pub use unavailable::{Outcome, Unavailable};
pub use values::{PileUp, Values};
pub use vendor::VendorFinding;
