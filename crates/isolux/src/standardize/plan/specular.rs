//! The step that limits highlights.

use super::Planner;
use crate::specular::{HistogramRule, SpecularRule};
use crate::standardize::choice::SpecularStep;

impl Planner<'_> {
    pub(super) fn specular(&mut self) -> Option<SpecularRule> {
        let default = SpecularStep::Limit(SpecularRule::Histogram(HistogramRule::default()));
        let SpecularStep::Limit(rule) = self.choice.specular.unwrap_or(default) else { return None };
        self.step("specular", rule.name(), rule.parameters());
        Some(rule)
    }
}
