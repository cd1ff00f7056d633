//! A chain of corrections: planned once, applied to any number of frames.

use std::sync::Arc;

use super::apply::apply;
use super::error::StandardizeError;
use super::plan::Plan;
use super::prepared::Prepared;
use super::recording_traits::RecordingTraits;
use super::report::{AppliedStep, Note, PlanError};
use super::standardized::Standardized;
use super::workspace::Workspace;
use crate::calibration::Calibration;
use crate::choice::Choice;
use crate::denoise::{DenoiseRule, TemporalMean};
use crate::frame::{Channels, Frame};
use crate::specular::SpecularRule;

/// A chain of corrections, ready to apply to any frame of a recording. Cheap to clone, shareable between threads.
///
/// Frames go through [`Self::stream`], one after the other. Where several threads work on frames,
/// [`Stream::prepare`](super::Stream::prepare) takes them in order and [`Self::apply`] does the rest anywhere.
#[derive(Clone, Debug, PartialEq)]
pub struct Standardizer {
    plan: Arc<Plan>,
}

impl Standardizer {
    /// Plans the chain: the choice's steps, with the terms of `calibration`, for a recording with these traits. Its
    /// [`Channels`] alone will do; the step `angle` needs its intrinsics, and the profile is for one image format.
    ///
    /// # Errors
    /// [`PlanError`] when something asked for by name cannot be done.
    pub fn plan(
        choice: &Choice,
        calibration: Option<&Calibration>,
        recording: impl Into<RecordingTraits>,
    ) -> Result<Self, PlanError> {
        Ok(Self { plan: Arc::new(Plan::new(choice, calibration, recording.into())?) })
    }

    /// The steps, in the order in which they are applied.
    #[must_use]
    pub fn steps(&self) -> &[AppliedStep] {
        &self.plan.steps
    }

    /// What the user should know of the plan.
    #[must_use]
    pub fn notes(&self) -> &[Note] {
        &self.plan.notes
    }

    /// Channels that the chain reads.
    #[must_use]
    pub fn needed(&self) -> Channels {
        self.plan.needed()
    }

    /// True where [`Standardized::sigma`] is predicted.
    #[must_use]
    pub fn predicts_sigma(&self) -> bool {
        self.plan.sigma.is_some()
    }

    /// How many frames before a frame its result depends on: 0 unless the chain takes means over frames.
    #[must_use]
    pub fn frames_before(&self) -> usize {
        if self.plan.denoise == Some(DenoiseRule::Temporal) { TemporalMean::FRAMES - 1 } else { 0 }
    }

    /// Standardizes one frame into `out`; the frame itself stays as it is. `prepared` is what
    /// [`Stream::prepare`](super::Stream::prepare) made of the frame and those before it; the default standardizes the frame as the first of its stream. Allocates only
    /// when the shape differs from that of the last frame.
    ///
    /// # Errors
    /// [`StandardizeError`] when the frame lacks what the plan needs, or its planes differ in shape.
    pub fn apply(
        &self,
        frame: &Frame,
        prepared: &Prepared,
        workspace: &mut Workspace,
        out: &mut Standardized,
    ) -> Result<(), StandardizeError> {
        apply(&self.plan, frame, prepared, workspace, out)
    }

    /// The chain without its step for highlights, and that step.
    pub(super) fn without_highlights(&self) -> (Self, Option<SpecularRule>) {
        let mut plan = Plan::clone(&self.plan);
        let specular = plan.specular.take();
        (Self { plan: Arc::new(plan) }, specular)
    }
}
