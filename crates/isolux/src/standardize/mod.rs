//! Standardizing frames: plan once, then apply to each frame without allocating.
//!
//! A [`Standardizer`] is planned from a [`Choice`] of steps, a calibration, and what is known of the recording
//! ([`RecordingTraits`]). Its [`Stream`] takes frame after frame and gives back a [`Standardized`] each. Where several
//! threads share the work, [`Stream::prepare`] takes the frames in order and [`Standardizer::apply`] does the
//! arithmetic, with a [`Workspace`] for each thread.

mod apply;
mod error;
mod frame_lineariser;
mod kernel;
mod merge;
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

pub use crate::choice::{
    AngleStep, Choice, DenoiseStep, DistanceStep, Method, ProfileStep, SigmaStep, SpecularStep, TimeStep,
};
pub use error::StandardizeError;
pub use frame_lineariser::FrameLineariser;
pub use merge::{BracketMerge, MergeError};
pub use prepared::Prepared;
pub use recording_traits::RecordingTraits;
pub use report::{AppliedStep, Note, PlanError};
pub use standardized::{FrameSummary, Standardized};
pub use standardizer::Standardizer;
pub use stream::Stream;
pub use workspace::Workspace;
