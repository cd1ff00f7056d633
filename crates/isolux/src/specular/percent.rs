//! `percent`: the cutoff is a fraction of the maximum, or a quantile. The text of the paper says 90 % of the
//! maximum, the caption of its figure 13 reads as the upper 10 % of the pixels: both are offered.

use super::maximum::maximum;
use crate::numerics::quantile::PositiveQuantiles;

/// Parameters of the percent rule.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PercentRule {
    /// Cutoff at this fraction (0..=1) of the largest valid value.
    OfMaximum(f64),
    /// Cutoff at this quantile (0..=1) of the valid values.
    Quantile(f64),
}

impl Default for PercentRule {
    fn default() -> Self {
        Self::OfMaximum(0.9)
    }
}

impl PercentRule {
    pub(super) fn parameters(&self) -> String {
        match self {
            Self::OfMaximum(fraction) => format!("{fraction} of the maximum"),
            Self::Quantile(fraction) => format!("the {fraction} quantile"),
        }
    }

    pub(super) fn cutoff(&self, values: &[f32], quantiles: &mut PositiveQuantiles) -> Option<f32> {
        match *self {
            Self::OfMaximum(fraction) => {
                let maximum = maximum(values);
                (maximum > 0.0).then_some((fraction * f64::from(maximum)) as f32)
            }
            Self::Quantile(fraction) => quantiles.at(values, [fraction]).map(|([value], _)| value),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_readings_of_the_paper() {
        let values: Vec<f32> = (1..=11).map(|i| (i * i) as f32).collect();
        let mut memory = PositiveQuantiles::default();
        assert_eq!(PercentRule::OfMaximum(0.5).cutoff(&values, &mut memory), Some(60.5));
        assert_eq!(PercentRule::Quantile(0.9).cutoff(&values, &mut memory), Some(100.0));
        assert_eq!(PercentRule::OfMaximum(0.5).cutoff(&[f32::NAN, 0.0], &mut memory), None);
        assert_eq!(PercentRule::Quantile(0.5).cutoff(&[f32::NAN, 0.0], &mut memory), None);
    }
}
