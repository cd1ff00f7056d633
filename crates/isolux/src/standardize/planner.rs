//! What the steps are planned from, and the record of what was planned.

use super::recording_traits::RecordingTraits;
use super::report::{AppliedStep, Note, PlanError};
use crate::advice::RecordingKind;
use crate::calibration::Calibration;
use crate::choice::Choice;
use crate::frame::Channels;
use crate::step_names::Method;

/// Collects the plan; each step adds to it in turn.
pub(super) struct Planner<'a> {
    pub(super) choice: &'a Choice,
    pub(super) calibration: Option<&'a Calibration>,
    pub(super) traits: RecordingTraits,
    pub(super) steps: Vec<AppliedStep>,
    pub(super) notes: Vec<Note>,
}

impl<'a> Planner<'a> {
    pub(super) fn new(
        choice: &'a Choice,
        calibration: Option<&'a Calibration>,
        traits: RecordingTraits,
    ) -> Self {
        Self { choice, calibration, traits, steps: Vec::new(), notes: Vec::new() }
    }

    /// True when a step was asked for by name, or the method that requires it was.
    pub(super) fn is_required(&self, named: bool) -> bool {
        named || self.choice.method == Method::Paper
    }

    /// Whether the recording has the channel that a step needs. A missing channel is an error if the step is
    /// `required`, else a note.
    pub(super) fn has(
        &mut self,
        needed: Channels,
        [effect, term, channel]: [&'static str; 3],
        required: bool,
    ) -> Result<bool, PlanError> {
        if self.traits.channels.contains(needed) {
            return Ok(true);
        }
        if required {
            return Err(PlanError::ChannelMissing { term, channel });
        }
        self.notes.push(Note::ChannelMissing { effect, channel });
        Ok(false)
    }

    /// The error about a term that was asked for and is missing.
    pub(super) fn missing(&self, term: &'static str, fit_from: RecordingKind) -> PlanError {
        match self.calibration {
            Some(_) => PlanError::TermMissing { term, fit_from },
            None => PlanError::CalibrationMissing { term, fit_from },
        }
    }

    /// Adds a step; the steps are planned in the order in which they are applied.
    pub(super) fn step(&mut self, effect: &'static str, term: &'static str, parameters: String) {
        self.steps.push(AppliedStep { effect, term, parameters });
    }
}
