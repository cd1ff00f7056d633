//! Specular highlights (section 2.3 of the paper): a rule finds a cutoff in the standardized amplitudes (DN);
//! values above it are limited and flagged.

mod deviations;
mod histogram;
mod knee;
mod maximum;
mod notation;
mod percent;

pub use deviations::SigmaRule;
pub use histogram::HistogramRule;
pub use knee::KneeRule;
pub use notation::RuleError;
pub use percent::PercentRule;

use crate::frame::{PixelFlags, Plane};
use crate::numerics::quantile::PositiveQuantiles;

/// How the cutoff is found.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum SpecularRule {
    /// Highest value with enough occurrences (the paper's proposal).
    Histogram(HistogramRule),
    /// Mean plus a multiple of the standard deviation.
    Sigma(SigmaRule),
    /// Fraction of the maximum, or a quantile.
    Percent(PercentRule),
    /// Compression above the histogram's cutoff that keeps the order.
    Knee(KneeRule),
}

impl SpecularRule {
    /// Name on the command line and in recordings.
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self {
            Self::Histogram(_) => "histogram",
            Self::Sigma(_) => "sigma",
            Self::Percent(_) => "percent",
            Self::Knee(_) => "knee",
        }
    }

    /// The rule's parameter in words, for the record of applied steps.
    #[must_use]
    pub fn parameters(&self) -> String {
        match self {
            Self::Histogram(rule) => rule.parameters(),
            Self::Sigma(rule) => format!("{} standard deviations above the mean", rule.deviations),
            Self::Percent(rule) => rule.parameters(),
            Self::Knee(rule) => rule.parameters(),
        }
    }

    /// The value (DN) above which pixels count as specular; `None` when the rule finds none.
    pub(crate) fn cutoff(&self, values: &[f32], quantiles: &mut PositiveQuantiles) -> Option<f32> {
        match self {
            Self::Histogram(rule) => rule.cutoff(values, quantiles),
            Self::Sigma(rule) => rule.cutoff(values),
            Self::Percent(rule) => rule.cutoff(values, quantiles),
            Self::Knee(rule) => rule.cutoff(values, quantiles),
        }
    }

    /// Brings values above `cutoff` down, as the rule does it, and flags them.
    pub(crate) fn limit(&self, values: &mut Plane<f32>, flags: &mut Plane<PixelFlags>, cutoff: f32) {
        let (values, flags) = (values.values_mut(), flags.values_mut());
        match self {
            Self::Histogram(_) | Self::Sigma(_) | Self::Percent(_) => clip(values, flags, cutoff),
            Self::Knee(_) => knee::compress(values, flags, cutoff),
        }
    }
}

/// Sets values above `cutoff` to it and flags them.
fn clip(values: &mut [f32], flags: &mut [PixelFlags], cutoff: f32) {
    for (value, flags) in values.iter_mut().zip(flags) {
        let above = *value > cutoff;
        *value = if above { cutoff } else { *value };
        *flags |= PixelFlags::from_bits_retain(u16::from(above) * PixelFlags::SPECULAR.bits());
    }
}
