//! The step that removes the effect of the integration time: one multiplier per frame, or one per pixel.

use std::ops::Range;

use super::relative;
use super::response::{self, PlannedResponse, SaturationCorrection};
use crate::advice::RecordingKind;
use crate::calibration::{Calibration, REFERENCE_TIME_US};
use crate::common_factor::RelativeExposure;
use crate::frame::{Channels, Frame, IntegrationTime, PixelFlags};
use crate::standardize::error::StandardizeError;
use crate::standardize::planner::Planner;
use crate::standardize::report::{Note, PlanError};
use crate::step_names::{Method, TimeStep};
use crate::terms::lut::LutAnswer;
use crate::terms::response::ScalarResponse;
use crate::terms::{Lut, linear};

/// The step, ready to apply.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum TimePlan {
    Lut(Lut),
    Scalar {
        response: ScalarResponse,
        reference_us: f64,
    },
    /// Times outside those that were calibrated, where they are known, are flagged.
    Linear {
        reference_us: f64,
        calibrated_us: Option<[f64; 2]>,
    },
    /// What all still pixels of a frame share is taken out.
    Relative(RelativeExposure),
    None,
}

impl TimePlan {
    /// True where the integration time is read.
    pub(crate) fn reads_time(&self) -> bool {
        !matches!(self, Self::None | Self::Relative(_))
    }
}

/// Plans the multiplier over the integration time, and the saturation correction before it.
///
/// # Errors
/// [`PlanError`] when something asked for by name cannot be done.
pub(crate) fn plan(planner: &mut Planner<'_>) -> Result<(TimePlan, Option<SaturationCorrection>), PlanError> {
    let named = planner.choice.time;
    let wanted = named.unwrap_or_else(|| default_step(planner));
    if wanted == TimeStep::None {
        return Ok((TimePlan::None, None));
    }
    let term = wanted.name();
    if wanted == TimeStep::Relative {
        let (exposure, parameters) = relative::plan(planner)?;
        planner.step("time", term, parameters);
        return Ok((TimePlan::Relative(exposure), None));
    }
    let required = planner.is_required(named.is_some());
    if !planner.has(Channels::INTEGRATION_TIME, ["time", term, "integration time"], required)? {
        return Ok((TimePlan::None, None));
    }
    let reference_us =
        planner.calibration.and_then(|c| c.reference.integration_time_us).unwrap_or(REFERENCE_TIME_US);
    let calibrated_us = planner.calibration.and_then(calibrated_times_us);
    let (plan, correction, parameters) = match wanted {
        TimeStep::None | TimeStep::Relative => return Ok((TimePlan::None, None)),
        TimeStep::Linear => {
            // Below the calibrated times, pixels are the farther from saturation, and physics holds.
            let up_to = calibrated_us.filter(|_| named.is_none()).map(|[_, longest_us]| [0.0, longest_us]);
            let plan = TimePlan::Linear { reference_us, calibrated_us: up_to };
            (plan, None, format!("{reference_us} µs / t"))
        }
        TimeStep::Lut => {
            let lut = planner.calibration.and_then(|c| c.terms.lut.clone());
            let lut = lut.ok_or_else(|| planner.missing(term, RecordingKind::ExposureSweep))?;
            let [min_us, max_us] = lut.valid_integration_time_us;
            let parameters = format!("1 at {reference_us} µs, valid from {min_us} to {max_us} µs");
            (TimePlan::Lut(lut), None, parameters)
        }
        TimeStep::Response => match response::plan(planner, reference_us)? {
            (PlannedResponse::Scalar(response), words) => {
                (TimePlan::Scalar { response, reference_us }, None, words)
            }
            (PlannedResponse::PerPixel(correction), words) => {
                (TimePlan::Linear { reference_us, calibrated_us }, Some(correction), words)
            }
        },
    };
    planner.step("time", term, parameters);
    Ok((plan, correction))
}

/// The integration times, µs, that the terms of a calibration were fitted on.
fn calibrated_times_us(calibration: &Calibration) -> Option<[f64; 2]> {
    let terms = &calibration.terms;
    let response = terms.response.as_ref();
    let of_lut = terms.lut.as_ref().map(|lut| lut.valid_integration_time_us);
    let of_scalar = || response?.scalar.as_ref().map(|scalar| scalar.valid_integration_time_us);
    let of_pixel = || response?.pixel.as_ref().map(|pixel| pixel.valid_integration_time_us);
    of_lut.or_else(of_scalar).or_else(of_pixel)
}

/// The time step of the method; adds a note when `best` does not know the fill of the pixels.
///
/// Where it is not known, `t_ref / t` is right for every pixel that does not saturate. The table is right for the mean of
/// the scene that it was fitted on: it corrects dim pixels of other scenes by the saturation of that scene's bright ones.
fn default_step(planner: &mut Planner<'_>) -> TimeStep {
    match (planner.choice.method, planner.calibration) {
        (Method::Paper, _) => TimeStep::Lut,
        (Method::Best, _) if planner.traits.already.time => {
            planner.notes.push(Note::AlreadyCorrected { effect: "integration time" });
            TimeStep::None
        }
        (Method::Best, None) => TimeStep::Linear,
        (Method::Best, Some(_)) if response::measures_the_fill(planner) => TimeStep::Response,
        (Method::Best, Some(calibration)) => {
            let timed = planner.traits.channels.contains(Channels::INTEGRATION_TIME);
            let referred = calibration.terms.lut.is_some() || calibration.terms.response.is_some();
            if timed {
                planner.notes.push(if referred { Note::FillUnknown } else { Note::NoTimeTerm });
            }
            if referred { TimeStep::Linear } else { TimeStep::None }
        }
    }
}

/// The multipliers of a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum TimeGain<'a> {
    /// One for all pixels.
    Uniform(f32),
    /// One for each pixel.
    PerPixel(&'a [f32]),
}

impl TimeGain<'_> {
    /// Writes the multipliers of these pixels.
    pub(crate) fn write(self, pixels: Range<usize>, out: &mut [f32]) {
        match self {
            Self::Uniform(gain) => out.fill(gain),
            Self::PerPixel(gains) => out.copy_from_slice(&gains[pixels]),
        }
    }
}

/// The multipliers of a frame, and how many measured pixels are outside the fitted range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct TimeGains<'a> {
    pub(crate) gain: TimeGain<'a>,
    pub(crate) uncovered: Uncovered,
}

/// How many measured pixels of a frame the table does not cover.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Uncovered {
    /// Time above the range, or unknown.
    pub(crate) refused: usize,
    /// Time outside the range, but with a multiplier.
    pub(crate) extrapolated: usize,
}

/// A multiplier, and the flags of the pixels that get it. NaN where there is none.
type Answer = (f32, PixelFlags);

/// Computes the multipliers, those of single pixels into `memory`. Completes `flags`. `relative_gain` is the frame's
/// where the plan takes out what still pixels share.
///
/// # Errors
/// [`StandardizeError::TimeUnknown`] when the plan needs a time and the frame has none.
pub(crate) fn gains<'a>(
    plan: &TimePlan,
    frame: &Frame,
    relative_gain: Option<f32>,
    memory: &'a mut Vec<f32>,
    flags: &mut [PixelFlags],
) -> Result<TimeGains<'a>, StandardizeError> {
    // Also for frames that need no multiplier per pixel: the next frame may, and must not allocate.
    memory.resize(frame.shape().pixels(), f32::NAN);
    let mut uncovered = Uncovered::default();
    let gain = match (plan, &frame.integration_time_us) {
        (TimePlan::None, _) => TimeGain::Uniform(1.0),
        (TimePlan::Relative(exposure), _) => {
            let gain = relative_gain.unwrap_or_else(|| exposure.multiplier(0));
            if gain.is_nan() {
                let flag = PixelFlags::INVALID | PixelFlags::TIME_OUT_OF_RANGE;
                flags.iter_mut().for_each(|flags| uncovered.flag(flags, flag));
            }
            TimeGain::Uniform(gain)
        }
        (_, IntegrationTime::Unknown) => return Err(StandardizeError::TimeUnknown),
        (_, IntegrationTime::PerFrame(time_us)) => {
            let (gain, flag) = answer(plan, *time_us);
            if !flag.is_empty() {
                flags.iter_mut().for_each(|flags| uncovered.flag(flags, flag));
            }
            TimeGain::Uniform(gain)
        }
        (_, IntegrationTime::PerPixel(map)) => {
            let mut known = Memo::default();
            for ((&time_us, gain), flags) in map.values().iter().zip(&mut *memory).zip(flags) {
                let (value, flag) = known.get(time_us, |time_us| answer(plan, time_us));
                *gain = value;
                if !flag.is_empty() {
                    uncovered.flag(flags, flag);
                }
            }
            TimeGain::PerPixel(memory)
        }
    };
    Ok(TimeGains { gain, uncovered })
}

impl Uncovered {
    /// Flags one pixel; counts it if it was a measurement until now.
    fn flag(&mut self, flags: &mut PixelFlags, flag: PixelFlags) {
        let measured = !flags.contains(PixelFlags::INVALID);
        let refused = flag.contains(PixelFlags::INVALID);
        self.refused += usize::from(measured && refused);
        self.extrapolated += usize::from(measured && !refused);
        *flags |= flag;
    }
}

fn answer(plan: &TimePlan, time_us: f64) -> Answer {
    if !(time_us > 0.0 && time_us.is_finite()) {
        return (f32::NAN, PixelFlags::INVALID | PixelFlags::TIME_OUT_OF_RANGE);
    }
    match plan {
        TimePlan::None | TimePlan::Relative(_) => (1.0, PixelFlags::empty()),
        TimePlan::Linear { reference_us, calibrated_us } => {
            let beyond = calibrated_us.is_some_and(|[from, to]| !(from..=to).contains(&time_us));
            let gain = linear::multiplier(time_us, *reference_us) as f32;
            (gain, PixelFlags::TIME_OUT_OF_RANGE.when(beyond))
        }
        TimePlan::Lut(lut) => flagged(lut.at(time_us)),
        TimePlan::Scalar { response, reference_us } => flagged(response.at(time_us, *reference_us)),
    }
}

fn flagged(answer: LutAnswer) -> Answer {
    match answer {
        LutAnswer::Inside(gain) => (gain as f32, PixelFlags::empty()),
        LutAnswer::Below(gain) => (gain as f32, PixelFlags::TIME_OUT_OF_RANGE),
        LutAnswer::Refused => (f32::NAN, PixelFlags::INVALID | PixelFlags::TIME_OUT_OF_RANGE),
    }
}

/// Remembers the last few times: cameras that mix exposures within a frame use two or three.
#[derive(Default)]
struct Memo {
    entries: [Option<(u32, Answer)>; 4],
    oldest: usize,
}

impl Memo {
    fn get(&mut self, time_us: f32, compute: impl Fn(f64) -> Answer) -> Answer {
        let bits = time_us.to_bits();
        if let Some((_, answer)) = self.entries.iter().flatten().find(|(known, _)| *known == bits) {
            return *answer;
        }
        let answer = compute(f64::from(time_us));
        self.entries[self.oldest] = Some((bits, answer));
        self.oldest = (self.oldest + 1) % self.entries.len();
        answer
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::{Plane, Shape};

    #[test]
    fn a_map_of_times_gives_each_pixel_its_multiplier() {
        let times = [125.0, 5000.0, f32::NAN, 125.0, 0.0, 60.0, 70.0, 80.0, 125.0];
        let mut frame = Frame::new(Shape::new(3, 3));
        frame.integration_time_us =
            IntegrationTime::PerPixel(Plane::from_vec(Shape::new(3, 3), times.to_vec()).unwrap());
        let (mut memory, mut flags) = (Vec::new(), [PixelFlags::empty(); 9]);
        let plan = TimePlan::Linear { reference_us: 1000.0, calibrated_us: None };
        flags[4] = PixelFlags::INVALID;
        let found = gains(&plan, &frame, None, &mut memory, &mut flags).unwrap();
        assert_eq!(found.uncovered, Uncovered { refused: 1, extrapolated: 0 });
        let mut values = [0.0; 9];
        found.gain.write(0..9, &mut values);
        for (i, time) in times.into_iter().enumerate() {
            if time > 0.0 {
                assert_eq!((values[i], flags[i]), (1000.0 / time, PixelFlags::empty()));
            } else {
                assert!(values[i].is_nan() && flags[i].bits() == 0b1001, "{time}");
            }
        }
    }
}
