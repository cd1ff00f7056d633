//! The step that denoises the distance before it scales.

use super::Planner;
use crate::denoise::DenoiseRule;
use crate::standardize::choice::DenoiseStep;
use crate::standardize::report::{AppliedStep, Note};

impl Planner<'_> {
    /// Its step goes before that of the distance, which is planned already.
    pub(super) fn denoise(&mut self, distance_scales: bool) -> Option<DenoiseRule> {
        let Some(DenoiseStep::Smooth(rule)) = self.choice.denoise else { return None };
        if !distance_scales {
            self.notes.push(Note::NothingToDenoise);
            return None;
        }
        let step = AppliedStep { effect: "denoise", term: rule.name(), parameters: rule.parameters() };
        self.steps.insert(self.steps.len() - 1, step);
        Some(rule)
    }
}
