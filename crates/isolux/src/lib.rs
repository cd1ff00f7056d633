//! Standardizes the amplitude images of time-of-flight cameras: afterwards, one material has one value, whatever
//! the integration time and the distance, and highlights are limited.
//!
//! The method is that of Stürmer, Penne and Hornegger, "Standardization of Intensity-Values Acquired by
//! Time-of-Flight-Cameras" (CVPR Workshops 2008): a lookup table over the integration time, a polynomial over the
//! distance, and a cutoff from the histogram for highlights. Other terms go beyond the paper: the response of saturating
//! pixels, a spline over the distance, the illumination profile and the angle of incidence.
//!
//! A [`Frame`] goes in: amplitude in DN, distance in m, integration time in µs, images of height × width.
//! A [`Standardized`] comes out: the amplitude (DN) expected at the reference time and distance, flags, and on request
//! the standard deviation of each value. This crate reads and writes no files and starts no threads.
//!
//! | module | what it is for |
//! |---|---|
//! | [`standardize`] | plan a chain of corrections once, apply it to every frame |
//! | [`calibrate`] | measure recordings and fit the terms of a camera |
//! | [`calibration`] | the terms of one camera and the conditions they refer to, as its file holds them |
//! | [`terms`] | the corrections: the model, parameters and fit of each |
//! | [`denoise`] | smooth the distance before it scales the amplitude |
//! | [`specular`] | limit highlights |
//! | [`evaluate`] | measure how much better the standardized amplitudes are |
//! | [`diagnose`] | find out what the amplitudes of a recording depend on |
//! | [`inspect`] | find out from a few frames whether a recording means what it says |
//! | [`still_scene`] | check that a scene stood still while the integration time varied |
//! | [`phase`] | amplitude, distance and intensity from the raw bins |
//! | [`statistics`] | medians, robust slopes and moments that other crates share |
//! | [`advice`] | what a user can do about an error or a warning |
//! | [`names`] | the error about a name that does not exist |
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
mod common_factor;
pub mod denoise;
pub mod diagnose;
pub mod evaluate;
mod frame;
pub mod inspect;
mod memory;
pub mod names;
mod numerics;
mod outcome_json;
pub mod specular;
pub mod standardize;
mod step_names;
pub mod still_scene;
mod surface;
pub mod terms;

pub use advice::{Advice, RecordingField, RecordingKind};
pub use calibration::{Calibration, Reference};
pub use choice::Choice;
pub use common_factor::{ExposureClaim, ExposureCourse, SpannedFrames};
pub use denoise::DenoiseRule;
pub use frame::{
    Channels, Distortion, Frame, IntegrationTime, Intrinsics, Lens, LensError, PhaseConvention, PixelFlags,
    PixelRays, Plane, RayTable, Shape, ShapeError, SpinningLidar, Window, phase,
};
pub use numerics::statistics;
pub use specular::SpecularRule;
pub use standardize::{RecordingTraits, Standardized, Standardizer, Stream};
