//! The response: amplitudes are corrected for saturation, each by the fill of its pixel, before anything scales them.

use crate::advice::RecordingKind;
use crate::frame::{Channels, Frame, IntegrationTime, PixelFlags, Plane, Shape};
use crate::memory::bytes;
use crate::standardize::error::StandardizeError;
use crate::standardize::planner::Planner;
use crate::standardize::report::PlanError;
use crate::terms::response::{
    PlannedAmplitude, PlannedBins, PlannedIntensity, PlannedPixels, Response, ResponseTier, ScalarResponse,
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
    let (planned, words) = of_tier(response, tier, reference_us).ok_or_else(|| missing(tier.name()))?;
    let words = match planned {
        PlannedResponse::PerPixel(_) => format!("tier {tier}: {words}, then {reference_us} µs / t"),
        PlannedResponse::Scalar(_) => format!("tier {tier}: {words}"),
    };
    Ok((planned, words))
}

/// The plan of one tier; `None` where the tier was not fitted.
fn of_tier(response: &Response, tier: ResponseTier, reference_us: f64) -> Option<(PlannedResponse, String)> {
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

/// The best tier that calibration and recording allow.
fn best_tier(planner: &Planner<'_>, response: &Response) -> Option<ResponseTier> {
    response.tiers().find(|tier| planner.traits.channels.contains(tier.channels()))
}

/// True when the recording and the calibration allow a tier that measures the fill of each pixel, which no table
/// over time does.
pub(crate) fn measures_the_fill(planner: &Planner<'_>) -> bool {
    let response = planner.calibration.and_then(|c| c.terms.response.as_ref());
    let tier = response.and_then(|response| best_tier(planner, response));
    matches!(tier, Some(ResponseTier::PhaseSamples | ResponseTier::Intensity))
}

/// A tier of the response that is applied pixel by pixel.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum SaturationCorrection {
    Amplitude(PlannedAmplitude),
    Pixel(PlannedPixels),
    Intensity(PlannedIntensity),
    PhaseSamples(PlannedBins),
}

impl SaturationCorrection {
    /// The channels that it reads besides the amplitude.
    pub(crate) fn channels(&self) -> Channels {
        match self {
            Self::Amplitude(_) | Self::Pixel(_) => Channels::empty(),
            Self::Intensity(_) => Channels::INTENSITY,
            Self::PhaseSamples(_) => Channels::PHASE_SAMPLES,
        }
    }
}

/// Saturation-corrected amplitude and, where the tier repairs it, distance of a frame.
#[derive(Clone, Debug)]
pub(crate) struct Corrected {
    amplitude: Vec<f32>,
    distance_m: Plane<f32>,
}

/// The value of a pixel whose fill was not measured: the pixel is not saturated, but has no value.
const UNKNOWN: Option<f32> = Some(f32::NAN);

/// The corrected planes of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Repaired {
    Amplitude,
    AmplitudeAndDistance,
}

impl Default for Corrected {
    fn default() -> Self {
        Self { amplitude: Vec::new(), distance_m: Plane::filled(Shape::new(0, 0), f32::NAN) }
    }
}

impl Corrected {
    /// Bytes that it has allocated.
    pub(crate) fn bytes(&self) -> usize {
        bytes(&self.amplitude) + self.distance_m.bytes()
    }

    pub(crate) fn amplitude(&self) -> &[f32] {
        &self.amplitude
    }

    pub(crate) fn distance_m(&self) -> &Plane<f32> {
        &self.distance_m
    }

    /// Corrects `frame`. Measured pixels that are saturated or beyond the fitted range become SATURATED and
    /// INVALID, because their linear value cannot be determined. Allocates only when the shape differs from that of
    /// the last frame.
    ///
    /// # Errors
    /// [`StandardizeError`] when the frame lacks the channel or the time, or is not of the map's shape.
    pub(crate) fn fill(
        &mut self,
        correction: &SaturationCorrection,
        frame: &Frame,
        flags: &mut [PixelFlags],
    ) -> Result<Repaired, StandardizeError> {
        self.amplitude.resize(frame.shape().pixels(), f32::NAN);
        let amplitude = frame.amplitude.values();
        match correction {
            SaturationCorrection::Amplitude(planned) => {
                each(&mut self.amplitude, flags, |i| planned.linearise(amplitude[i]));
            }
            SaturationCorrection::Pixel(planned) => self.by_time(planned, frame, flags)?,
            SaturationCorrection::Intensity(planned) => {
                let channel = StandardizeError::FillMissing { channel: "intensity" };
                let intensity = frame.intensity.as_ref().ok_or(channel)?.values();
                each(&mut self.amplitude, flags, |i| match intensity[i].is_nan() {
                    true => UNKNOWN,
                    false => planned.linearise(intensity[i], amplitude[i]),
                });
            }
            SaturationCorrection::PhaseSamples(planned) => return self.by_bins(planned, frame, flags),
        }
        Ok(Repaired::Amplitude)
    }

    /// Corrects by the integration time, for the scene of the sweep only.
    fn by_time(
        &mut self,
        planned: &PlannedPixels,
        frame: &Frame,
        flags: &mut [PixelFlags],
    ) -> Result<(), StandardizeError> {
        let (found, expected) = (frame.shape(), planned.shape);
        if found != expected {
            return Err(StandardizeError::AnotherScene { found, expected });
        }
        let amplitude = frame.amplitude.values();
        match &frame.integration_time_us {
            IntegrationTime::Unknown => return Err(StandardizeError::TimeUnknown),
            IntegrationTime::PerFrame(time_us) => {
                each(&mut self.amplitude, flags, |i| planned.linearise(i, amplitude[i], *time_us));
            }
            IntegrationTime::PerPixel(map) => {
                let times_us = map.values();
                each(&mut self.amplitude, flags, |i| match f64::from(times_us[i]) {
                    time_us if time_us > 0.0 => planned.linearise(i, amplitude[i], time_us),
                    // The time step flags pixels without a time.
                    _ => Some(amplitude[i]),
                });
            }
        }
        Ok(())
    }

    /// Corrects amplitude and distance by the raw bins.
    fn by_bins(
        &mut self,
        planned: &PlannedBins,
        frame: &Frame,
        flags: &mut [PixelFlags],
    ) -> Result<Repaired, StandardizeError> {
        let channel = StandardizeError::FillMissing { channel: "phase_samples" };
        let [a1, a2, a3, a4] = frame.phase_samples.as_ref().ok_or(channel)?.each_ref().map(Plane::values);
        let linear = |i: usize| match [a1[i], a2[i], a3[i], a4[i]] {
            bins if bins.iter().any(|bin| bin.is_nan()) => UNKNOWN.map(|unknown| (unknown, 0.0)),
            bins => planned.linearise(bins),
        };
        let Some(delivered) = frame.distance_m.as_ref().filter(|_| planned.repairs_distance()) else {
            each(&mut self.amplitude, flags, |i| linear(i).map(|(amplitude, _)| amplitude));
            return Ok(Repaired::Amplitude);
        };
        let delivered = delivered.values();
        self.distance_m.reshape(frame.shape(), f32::NAN);
        let repaired = self.distance_m.values_mut();
        repaired.copy_from_slice(delivered);
        each(&mut self.amplitude, flags, |i| {
            let Some((amplitude, shift_m)) = linear(i) else {
                // Clipped bins give a wrong distance, which must not enter the smoothing of neighbours.
                repaired[i] = f32::NAN;
                return None;
            };
            // An invalid distance must stay invalid.
            if delivered[i] > 0.0 {
                repaired[i] += shift_m;
            }
            Some(amplitude)
        });
        Ok(Repaired::AmplitudeAndDistance)
    }
}

/// Writes the corrected value of every measured pixel that has one; the others become SATURATED and INVALID.
fn each(amplitude: &mut [f32], flags: &mut [PixelFlags], mut linear: impl FnMut(usize) -> Option<f32>) {
    for (index, (value, flags)) in amplitude.iter_mut().zip(flags).enumerate() {
        if flags.contains(PixelFlags::INVALID) {
            *value = f32::NAN;
            continue;
        }
        let found = if flags.contains(PixelFlags::SATURATED) { None } else { linear(index) };
        *value = found.unwrap_or(f32::NAN);
        if found.is_none() {
            *flags |= PixelFlags::SATURATED | PixelFlags::INVALID;
        }
    }
}
