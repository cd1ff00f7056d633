//! The response as the step that takes the integration time out: which tier, and what it says of itself.

use super::{Planner, TimePlan};
use crate::standardize::linearise::Lineariser;
use crate::standardize::report::PlanError;
use crate::terms::response::{Response, ResponseTier};

impl Planner<'_> {
    /// The tier that was asked for, or the best one.
    pub(super) fn response(
        &mut self,
        reference_us: f64,
    ) -> Result<(TimePlan, Option<Lineariser>), PlanError> {
        let fitted = self.calibration.and_then(|c| c.terms.response.as_ref());
        let response = fitted.ok_or_else(|| self.missing("response", "--exposure-sweep"))?;
        let tier = match self.choice.response_tier {
            Some(tier) => tier,
            None => self.best_tier(response).ok_or_else(|| self.missing("response", "--exposure-sweep"))?,
        };
        if !self.stream.channels.contains(tier.channels()) {
            return Err(PlanError::ChannelMissing { term: tier.name(), channel: tier.name() });
        }
        let linear = TimePlan::Linear { reference_us };
        let (time, lineariser, words) = match tier {
            ResponseTier::Scalar => {
                let scalar = response.scalar.clone().ok_or_else(|| self.tier_missing(tier))?;
                let [min_us, max_us] = scalar.valid_integration_time_us;
                let words = format!("1 at {reference_us} µs, valid from {min_us} to {max_us} µs");
                (TimePlan::Scalar { response: scalar, reference_us }, None, words)
            }
            ResponseTier::Amplitude => {
                let tier = response.amplitude.as_ref().ok_or_else(|| self.tier_missing(tier))?;
                let words = format!("amplitudes up to {:.0} DN", tier.largest_dn);
                (linear, Some(Lineariser::Amplitude(tier.planned())), words)
            }
            ResponseTier::Pixel => {
                let tier = response.pixel.as_ref().ok_or_else(|| self.tier_missing(tier))?;
                let shape = tier.shape();
                let words = format!(
                    "the static scene of the sweep, {shape} pixels, up to a fill of {:.2}",
                    tier.largest_fill
                );
                (linear, Some(Lineariser::Pixel(tier.planned())), words)
            }
            ResponseTier::Intensity => {
                let tier = response.intensity.as_ref().ok_or_else(|| self.tier_missing(tier))?;
                let words = format!("intensity + amplitude up to {:.0} DN", tier.largest_dn);
                (linear, Some(Lineariser::Intensity(tier.planned())), words)
            }
            ResponseTier::PhaseSamples => {
                let tier = response.phase_samples.as_ref().ok_or_else(|| self.tier_missing(tier))?;
                let planned = tier.planned();
                let repaired =
                    if planned.repairs_distance() { "amplitude and distance" } else { "amplitude" };
                let words = format!("{repaired} from bins up to {:.0} DN", tier.largest_dn);
                (linear, Some(Lineariser::PhaseSamples(planned)), words)
            }
        };
        let name = tier.name();
        let words = match lineariser {
            Some(_) => format!("tier {name}: {words}, then {reference_us} µs / t"),
            None => format!("tier {name}: {words}"),
        };
        self.step("time", "response", words);
        Ok((time, lineariser))
    }

    /// The best tier that calibration and recording allow.
    fn best_tier(&self, response: &Response) -> Option<ResponseTier> {
        response.tiers().find(|tier| self.stream.channels.contains(tier.channels()))
    }

    /// True where the fill of each pixel is measured, which no table over time can know.
    pub(super) fn has_better_than_the_lut(&self) -> bool {
        let response = self.calibration.and_then(|c| c.terms.response.as_ref());
        let tier = response.and_then(|response| self.best_tier(response));
        matches!(tier, Some(ResponseTier::PhaseSamples | ResponseTier::Intensity))
    }

    fn tier_missing(&self, tier: ResponseTier) -> PlanError {
        self.missing(tier.name(), "--exposure-sweep")
    }
}
