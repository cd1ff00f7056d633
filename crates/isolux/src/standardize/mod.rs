//! Standardizing frames: plan once, then apply to each frame without allocating.
//!
//! A [`Standardizer`] is planned from a [`Choice`] of steps, a calibration, and what is known of the recording
//! ([`RecordingTraits`]). Its [`Stream`] takes one frame after the other and returns a [`Standardized`] for each. Where
//! several threads share the work, [`Stream::prepare`] takes the frames in order and [`Standardizer::apply`] does the
//! arithmetic, with a [`Workspace`] for each thread.
//!
//! The steps, in the order in which they are applied to the amplitude A (DN) of a pixel:
//!
//! | step | what it removes | how |
//! |---|---|---|
//! | time | integration time t, µs | table, `t_ref / t`, saturation-corrected amplitude times `t_ref / t`, or what still pixels share |
//! | denoise | noise of the distance | smooths the distances (m) that the next step reads |
//! | distance | radial distance d, m | cubic, spline, `(d / d_ref)²`, or eq. 5 of the paper |
//! | profile | illumination profile | divides by the gain of the pixel |
//! | angle | angle of incidence θ | divides by `cos^k θ` |
//! | sigma | | predicts the standard deviation (DN) of each value and removes the bias that the distance's noise causes |
//! | specular | highlights | limits values above a cutoff (DN) |
//!
//! Frames of a bracket (a still scene at several integration times) are merged by [`BracketMerge`].

mod ambient_light;
mod apply;
mod error;
mod frame_lineariser;
mod kernel;
mod merge;
mod other_camera;
mod plan;
mod planner;
mod prepared;
mod recording_traits;
mod report;
mod standardized;
mod standardizer;
mod steps;
mod stream;
mod workspace;

pub use crate::choice::{Choice, DenoiseStep, SpecularStep};
pub use crate::common_factor::{ExposureSurvey, RelativeExposure};
pub use crate::step_names::{AngleStep, DistanceStep, Method, ProfileStep, SigmaStep, TimeStep};
pub use ambient_light::AmbientLight;
pub use error::StandardizeError;
pub use frame_lineariser::FrameLineariser;
pub use merge::{BracketMerge, MergeError};
pub use prepared::Prepared;
pub use recording_traits::{AlreadyCorrected, RecordingTraits};
pub use report::{AppliedStep, Note, PlanError};
pub use standardized::{FrameSummary, Standardized};
pub use standardizer::Standardizer;
pub use stream::Stream;
pub use workspace::Workspace;
