//! Standardizes the amplitude images of time-of-flight cameras: one material has one value, whatever the
//! integration time and the distance, without specular outliers.
//!
//! The method is that of Stürmer, Penne and Hornegger, "Standardization of Intensity-Values Acquired by
//! Time-of-Flight-Cameras" (CVPR Workshops 2008): a lookup table over integration time, a polynomial over
//! distance, a histogram cutoff for highlights; see [`terms`] and [`specular`]. [`denoise`] smooths the distance
//! before it scales.
//!
//! [`calibrate`] fits a [`Calibration`] to recordings of your camera. A [`Standardizer`] is planned once, and its
//! [`Stream`] takes frame after frame, each a [`Frame`]. [`evaluate`] measures how much better the result is. This crate
//! knows no files and starts no threads.
//!
//! The folder `examples` of this crate has four short programs to read in their order, with frames of a simulated
//! camera: `01_standardize`, `02_calibrate`, `03_evaluate` and `04_live`.
//!
//! ```
//! use isolux::{Channels, Choice, Frame, IntegrationTime, Plane, Shape, Standardizer};
//!
//! let shape = Shape::new(2, 2);
//! let mut frame = Frame::new(shape);
//! frame.amplitude = Plane::from_vec(shape, vec![100.0, 25.0, f32::NAN, 400.0])?;
//! frame.distance_m = Some(Plane::from_vec(shape, vec![0.75, 1.5, 1.0, 0.375])?);
//! frame.integration_time_us = IntegrationTime::PerFrame(8200.0);
//! frame.flag_amplitude(None);
//!
//! // Without a calibration, the steps are textbook physics: t_ref / t and (d / d_ref)².
//! let channels = Channels::AMPLITUDE | Channels::DISTANCE | Channels::INTEGRATION_TIME;
//! let standardizer = Standardizer::plan(&Choice::default(), None, channels)?;
//! let mut stream = standardizer.stream();
//! let out = stream.push(&frame)?;
//! assert_eq!(out.summary.valid, 3);
//! assert_eq!(out.amplitude.get(0, 0), out.amplitude.get(0, 1));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod advice;
pub mod calibrate;
pub mod calibration;
mod choice;
pub mod denoise;
pub mod diagnose;
pub mod evaluate;
mod frame;
mod memory;
pub mod names;
mod numerics;
mod outcome_json;
pub mod specular;
pub mod standardize;
pub mod still_scene;
mod surface;
pub mod terms;

pub use advice::{Advice, RecordingKind};
pub use calibration::{Calibration, Reference};
pub use choice::Choice;
pub use denoise::DenoiseRule;
pub use frame::{
    Channels, Frame, IntegrationTime, Intrinsics, PhaseConvention, PixelFlags, Plane, Shape, ShapeError,
    Window, phase,
};
pub use numerics::statistics;
pub use specular::SpecularRule;
pub use standardize::{RecordingTraits, Standardized, Standardizer, Stream};
