//! The response: amplitudes are corrected for saturation, each by the fill of its pixel, before anything scales them.

mod corrected;

pub(crate) use corrected::{Corrected, Fill, Repaired};

use crate::advice::RecordingKind;
use crate::frame::Channels;
use crate::standardize::AmbientLight;
use crate::standardize::planner::Planner;
use crate::standardize::report::PlanError;
use crate::step_names::{Method, TimeStep};
use crate::terms::response::{
    AmbientResponse, PlannedAmbient, PlannedAmplitude, PlannedBins, PlannedIntensity, PlannedPixels,
    Response, ResponseTier, ScalarResponse,
};

/// What the step does: a multiplier over the integration time, or a saturation correction of each pixel before
/// `t_ref / t`.
pub(crate) enum PlannedResponse {
    Scalar(ScalarResponse),
    PerPixel(SaturationCorrection),
}

/// Plans the tier that was asked for, or the best one; the text records what it does.
///
/// # Errors
/// [`PlanError`] when calibration or recording lack what the tier needs.
pub(crate) fn plan(planner: &Planner<'_>, reference_us: f64) -> Result<(PlannedResponse, String), PlanError> {
    let missing = |term| planner.missing(term, RecordingKind::ExposureSweep);
    let fitted = planner.calibration.and_then(|c| c.terms.response.as_ref());
    let response = fitted.ok_or_else(|| missing("response"))?;
    let chosen = planner.choice.response_tier.or_else(|| best_tier(planner, response));
    let tier = chosen.ok_or_else(|| missing("response"))?;
    if !planner.traits.channels.contains(tier.channels()) {
        return Err(PlanError::ChannelMissing { term: tier.name(), channel: tier.name() });
    }
    if tier == ResponseTier::Ambient && planner.traits.ambient_light.is_none() {
        return Err(PlanError::AmbientLightUnknown);
    }
    let light = planner.traits.ambient_light.as_ref();
    let (planned, words) =
        of_tier(response, tier, reference_us, light).ok_or_else(|| missing(tier.name()))?;
    let words = match planned {
        PlannedResponse::PerPixel(_) => format!("tier {tier}: {words}, then {reference_us} µs / t"),
        PlannedResponse::Scalar(_) => format!("tier {tier}: {words}"),
    };
    Ok((planned, words))
}

/// The plan of one tier; `None` where the tier was not fitted.
fn of_tier(
    response: &Response,
    tier: ResponseTier,
    reference_us: f64,
    light: Option<&AmbientLight>,
) -> Option<(PlannedResponse, String)> {
    let (correction, words) = match tier {
        ResponseTier::Scalar => {
            let scalar = response.scalar.clone()?;
            let [min_us, max_us] = scalar.valid_integration_time_us;
            let words = format!("1 at {reference_us} µs, valid from {min_us} to {max_us} µs");
            return Some((PlannedResponse::Scalar(scalar), words));
        }
        ResponseTier::Amplitude => {
            let tier = response.amplitude.as_ref()?;
            let words = format!("amplitudes up to {:.0} DN", tier.largest_dn);
            (SaturationCorrection::Amplitude(tier.planned()), words)
        }
        ResponseTier::Pixel => {
            let tier = response.pixel.as_ref()?;
            let (shape, fill) = (tier.shape(), tier.largest_fill);
            let words = format!("the static scene of the sweep, {shape} pixels, up to a fill of {fill:.2}");
            (SaturationCorrection::Pixel(tier.planned()), words)
        }
        ResponseTier::Ambient => {
            let (tier, light) = (response.ambient.as_ref()?, light?);
            let words = words_about(light, tier.ambient_dn_per_us);
            (SaturationCorrection::Ambient { planned: Box::new(tier.planned()), light: light.clone() }, words)
        }
        ResponseTier::Intensity => {
            let tier = response.intensity.as_ref()?;
            let words = format!("intensity + amplitude up to {:.0} DN", tier.largest_dn);
            (SaturationCorrection::Intensity(tier.planned()), words)
        }
        ResponseTier::PhaseSamples => {
            let tier = response.phase_samples.as_ref()?;
            let planned = tier.planned();
            let repaired = if planned.repairs_distance() { "amplitude and distance" } else { "amplitude" };
            let words = format!("{repaired} from bins up to {:.0} DN", tier.largest_dn);
            (SaturationCorrection::PhaseSamples(planned), words)
        }
    };
    Some((PlannedResponse::PerPixel(correction), words))
}

/// An ambient light beside that of the calibration.
fn words_about(light: &AmbientLight, calibrated_dn_per_us: f64) -> String {
    let AmbientLight { dn_per_us, error_dn_per_us, course, .. } = light;
    let drift = if course.is_empty() { "" } else { ", drifting" };
    format!(
        "fill by amplitude and distance (wiener), ambient light {dn_per_us:.3} ± {error_dn_per_us:.3} DN/µs on the \
         target{drift}, {:.2} times that of the calibration",
        dn_per_us / calibrated_dn_per_us
    )
}

/// The tiers whose channels the recording has, the best first.
fn possible<'a>(planner: &'a Planner<'_>, response: &'a Response) -> impl Iterator<Item = ResponseTier> + 'a {
    response.tiers().filter(|tier| planner.traits.channels.contains(tier.channels()))
}

/// The best tier that calibration and recording allow.
fn best_tier(planner: &Planner<'_>, response: &Response) -> Option<ResponseTier> {
    let light_is_known = planner.traits.ambient_light.is_some();
    possible(planner, response).find(|tier| *tier != ResponseTier::Ambient || light_is_known)
}

/// The tier by amplitude and distance, where nothing better tells the fill and the plan would use it if the ambient light
/// were known.
pub(crate) fn wants_ambient_light<'a>(planner: &Planner<'a>) -> Option<&'a AmbientResponse> {
    let response = planner.calibration?.terms.response.as_ref()?;
    let ambient = response.ambient.as_ref()?;
    let tier = planner.choice.response_tier.or_else(|| possible(planner, response).next());
    let timed = match planner.choice.time {
        Some(step) => step == TimeStep::Response,
        None => planner.choice.method == Method::Best,
    };
    let channels = ResponseTier::Ambient.channels() | Channels::AMPLITUDE | Channels::INTEGRATION_TIME;
    let fine = tier == Some(ResponseTier::Ambient) && timed && planner.traits.channels.contains(channels);
    fine.then_some(ambient)
}

/// True when the recording and the calibration allow a tier that measures the fill of each pixel, which no table
/// over time does.
pub(crate) fn measures_the_fill(planner: &Planner<'_>) -> bool {
    let response = planner.calibration.and_then(|c| c.terms.response.as_ref());
    let tier = response.and_then(|response| best_tier(planner, response));
    matches!(tier, Some(ResponseTier::PhaseSamples | ResponseTier::Intensity | ResponseTier::Ambient))
}

/// A tier of the response that is applied pixel by pixel.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum SaturationCorrection {
    Amplitude(PlannedAmplitude),
    Pixel(PlannedPixels),
    Ambient { planned: Box<PlannedAmbient>, light: AmbientLight },
    Intensity(PlannedIntensity),
    PhaseSamples(PlannedBins),
}

impl SaturationCorrection {
    /// The channels that it reads besides the amplitude.
    pub(crate) fn channels(&self) -> Channels {
        match self {
            Self::Amplitude(_) | Self::Pixel(_) => Channels::empty(),
            Self::Ambient { .. } => Channels::DISTANCE | Channels::INTEGRATION_TIME,
            Self::Intensity(_) => Channels::INTENSITY,
            Self::PhaseSamples(_) => Channels::PHASE_SAMPLES,
        }
    }
}
