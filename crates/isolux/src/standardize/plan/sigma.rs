//! The prediction of the standard deviation.

use super::Planner;
use crate::calibration::Calibration;
use crate::frame::Channels;
use crate::frame::phase::SPEED_OF_LIGHT_M_PER_S;
use crate::standardize::choice::SigmaStep;
use crate::standardize::report::{Note, PlanError};
use crate::terms::NoiseModel;
use crate::terms::noise::AmplitudeNoise;

/// What the prediction rests on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::standardize) struct SigmaPlan {
    pub(in crate::standardize) noise: NoiseModel,
    /// σ_d in m of a pixel of signal-to-noise ratio 1; `None`: estimated from each frame.
    pub(in crate::standardize) unit_noise_m: Option<f64>,
    /// Channels that it reads besides those of the other steps.
    pub(in crate::standardize) needed: Channels,
}

impl Planner<'_> {
    pub(super) fn sigma(&mut self, distance_scales: bool) -> Result<Option<SigmaPlan>, PlanError> {
        let required = match self.choice.sigma {
            SigmaStep::None => return Ok(None),
            SigmaStep::WhereKnown => false,
            SigmaStep::Required => true,
        };
        let fitted = |calibration: &Calibration| calibration.terms.noise.as_ref().map(|noise| noise.model());
        let Some(noise) = self.choice.noise.or(self.calibration.and_then(fitted)) else {
            return if required { Err(PlanError::NoiseUnknown) } else { Ok(None) };
        };
        noise.check()?;
        let by_intensity = noise.by_intensity.filter(|_| self.stream.channels.contains(Channels::INTENSITY));
        let AmplitudeNoise { ambient_variance_dn2_per_us: ambient, .. } = noise.by_amplitude;
        let needed = match by_intensity {
            Some(_) => Channels::INTENSITY,
            None if ambient > 0.0 => Channels::INTEGRATION_TIME,
            None => Channels::empty(),
        };
        if !self.has(needed, "sigma", "sigma", "integration time", required)? {
            return Ok(None);
        }
        let unit_noise_m = self
            .choice
            .modulation_frequency_hz
            .map(|frequency_hz| SPEED_OF_LIGHT_M_PER_S / (4.0 * std::f64::consts::PI * frequency_hz));
        let light = if by_intensity.is_some() { "intensity" } else { "amplitude" };
        let distance = match (distance_scales, unit_noise_m) {
            (false, _) => "",
            (true, Some(_)) => ", that of the distance by the modulation frequency",
            (true, None) => ", that of the distance estimated per frame",
        };
        if distance_scales && unit_noise_m.is_none() {
            self.notes.push(Note::FrequencyUnknown);
        }
        let parameters =
            format!("noise of the amplitude by the {light}{distance}; ½ s″ σ_d² taken off the value");
        self.step("sigma", "noise", parameters);
        Ok(Some(SigmaPlan { noise: NoiseModel { by_intensity, ..noise }, unit_noise_m, needed }))
    }
}
