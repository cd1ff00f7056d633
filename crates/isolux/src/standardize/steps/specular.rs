//! The step that limits highlights.

use crate::choice::SpecularStep;
use crate::numerics::quantile::PositiveQuantiles;
use crate::specular::{HistogramRule, SpecularRule};
use crate::standardize::planner::Planner;
use crate::standardize::standardized::Standardized;

/// Plans the step: the histogram rule unless something else is chosen.
pub(crate) fn plan(planner: &mut Planner<'_>) -> Option<SpecularRule> {
    let default = SpecularStep::Limit(SpecularRule::Histogram(HistogramRule::default()));
    let SpecularStep::Limit(rule) = planner.choice.specular.unwrap_or(default) else { return None };
    planner.step("specular", rule.name(), rule.parameters());
    Some(rule)
}

/// Limits the highlights of a frame. Returns the cutoff, DN; `None` when the rule found none.
pub(crate) fn limit(
    rule: SpecularRule,
    out: &mut Standardized,
    quantiles: &mut PositiveQuantiles,
) -> Option<f32> {
    quantiles.reserve(out.amplitude.shape().pixels());
    let cutoff = rule.cutoff(out.amplitude.values(), quantiles)?;
    rule.limit(&mut out.amplitude, &mut out.flags, cutoff);
    Some(cutoff)
}
