//! A chain of corrections: planned once, applied to any number of frames.

use std::sync::Arc;

use super::apply::apply;
use super::error::StandardizeError;
use super::plan::Plan;
use super::planner::Planner;
use super::prepared::Prepared;
use super::recording_traits::RecordingTraits;
use super::report::{AppliedStep, Note, PlanError};
use super::standardized::Standardized;
use super::steps::response::{SaturationCorrection, wants_ambient_light};
use super::steps::time::TimePlan;
use super::workspace::Workspace;
use crate::calibration::Calibration;
use crate::choice::Choice;
use crate::denoise::{DenoiseRule, TemporalMean};
use crate::frame::{Channels, Frame};
use crate::specular::SpecularRule;
use crate::terms::response::AmbientResponse;

/// A chain of corrections, ready to apply to any frame of a recording. It is cheap to clone and can be shared
/// between threads.
///
/// Frames are pushed into [`Self::stream`], one after the other. Where several threads share the work,
/// [`Stream::prepare`](super::Stream::prepare) takes the frames in order, and [`Self::apply`] does the rest in any
/// thread.
#[derive(Clone, Debug, PartialEq)]
pub struct Standardizer {
    plan: Arc<Plan>,
}

impl Standardizer {
    /// Plans the chain: the steps of `choice`, with the terms of `calibration`, for a recording with these traits.
    /// The recording's [`Channels`] alone are enough, except that the angle step needs its intrinsics. The profile
    /// is valid for one shape of frames.
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

    /// The response that the plan of this choice would use if the ambient light of the recording were known: estimate it
    /// with an [`AmbientSurvey`](crate::calibrate::AmbientSurvey) and put it into
    /// [`RecordingTraits::ambient_light`]. `None` where the plan does not need it.
    #[must_use]
    pub fn wants_ambient_light<'a>(
        choice: &'a Choice,
        calibration: Option<&'a Calibration>,
        traits: &RecordingTraits,
    ) -> Option<&'a AmbientResponse> {
        wants_ambient_light(&Planner::new(choice, calibration, traits.clone()))
    }

    /// The steps, in the order in which they are applied.
    #[must_use]
    pub fn steps(&self) -> &[AppliedStep] {
        &self.plan.steps
    }

    /// What the user should know about the plan.
    #[must_use]
    pub fn notes(&self) -> &[Note] {
        &self.plan.notes
    }

    /// Channels that the chain reads.
    #[must_use]
    pub fn needed(&self) -> Channels {
        self.plan.needed()
    }

    /// True when the chain predicts [`Standardized::sigma`].
    #[must_use]
    pub fn predicts_sigma(&self) -> bool {
        self.plan.sigma.is_some()
    }

    /// Ambient light of a frame, counted from 0, DN/µs, where the chain corrects by one that drifts.
    pub(super) fn ambient_dn_per_us(&self, frame: usize) -> Option<f64> {
        match &self.plan.saturation {
            Some(SaturationCorrection::Ambient { light, .. }) => Some(light.at(frame)),
            _ => None,
        }
    }

    /// Multiplier of a frame, counted from 0, where the chain takes out what its still pixels share.
    pub(super) fn relative_gain(&self, frame: usize) -> Option<f32> {
        match &self.plan.time {
            TimePlan::Relative(exposure) => Some(exposure.multiplier(frame)),
            _ => None,
        }
    }

    /// Number of earlier frames that the result of a frame depends on: 0 unless the chain averages over frames.
    #[must_use]
    pub fn frames_before(&self) -> usize {
        if self.plan.denoise == Some(DenoiseRule::Temporal) { TemporalMean::FRAMES - 1 } else { 0 }
    }

    /// Standardizes one frame into `out`; the frame is not changed. `prepared` holds what
    /// [`Stream::prepare`](super::Stream::prepare) computed from the frame and those before it; the default treats
    /// the frame as the first of its stream. Allocates only when the shape differs from that of the last frame.
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
