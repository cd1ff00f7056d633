//! What the steps are planned from, and what they leave behind.

use super::recording_traits::RecordingTraits;
use super::report::{AppliedStep, Note, PlanError};
use crate::advice::RecordingKind;
use crate::calibration::Calibration;
use crate::choice::{Choice, Method};
use crate::frame::Channels;

/// Collects the plan while one step after the other adds to it.
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

    /// A step is required when it, or the method that consists of it, was asked for by name.
    pub(super) fn is_required(&self, named: bool) -> bool {
        named || self.choice.method == Method::Paper
    }

    /// Whether the recording has what a step needs. Where it has not, that is an error if the step is `required`, a
    /// note if not.
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

    /// The error about a term that was asked for and is not there.
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
