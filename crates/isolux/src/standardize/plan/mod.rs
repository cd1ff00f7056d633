//! From the user's choice, the calibration and the channels at hand to the steps that will be applied.

mod denoise;
mod distance;
mod illumination;
mod response;
mod sigma;
mod specular;
mod time;

use super::choice::{Choice, Method, Stream};
use super::linearise::Lineariser;
use super::report::{AppliedStep, Note, PlanError};
use crate::calibration::Calibration;
use crate::denoise::DenoiseRule;
use crate::frame::Channels;
use crate::specular::SpecularRule;
use crate::terms::response::ScalarResponse;
use crate::terms::{DistanceGain, DistanceTable, Lut};

pub(in crate::standardize) use illumination::{AnglePlan, IlluminationPlan, ProfilePlan};
pub(in crate::standardize) use sigma::SigmaPlan;

/// The integration-time step, ready to apply.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::standardize) enum TimePlan {
    Lut(Lut),
    Scalar { response: ScalarResponse, reference_us: f64 },
    Linear { reference_us: f64 },
    None,
}

/// Everything that depends on the calibration alone.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::standardize) struct Plan {
    /// `None` takes the amplitude as delivered.
    pub(in crate::standardize) lineariser: Option<Lineariser>,
    pub(in crate::standardize) time: TimePlan,
    /// `None` scales by the distance as delivered.
    pub(in crate::standardize) denoise: Option<DenoiseRule>,
    /// `None` leaves the distance in.
    pub(in crate::standardize) distance: Option<DistanceGain>,
    /// A factor on that law, for laws that are no polynomial.
    pub(in crate::standardize) distance_table: Option<DistanceTable>,
    pub(in crate::standardize) illumination: IlluminationPlan,
    pub(in crate::standardize) specular: Option<SpecularRule>,
    /// `None` predicts no standard deviation.
    pub(in crate::standardize) sigma: Option<SigmaPlan>,
    pub(in crate::standardize) low_signal_below_dn: f32,
    pub(in crate::standardize) steps: Vec<AppliedStep>,
    pub(in crate::standardize) notes: Vec<Note>,
}

impl Plan {
    /// Decides each step.
    ///
    /// # Errors
    /// [`PlanError`] when something asked for by name cannot be done.
    pub(in crate::standardize) fn new(
        choice: &Choice,
        calibration: Option<&Calibration>,
        stream: Stream,
    ) -> Result<Self, PlanError> {
        if let Some(calibration) = calibration {
            calibration.check()?;
        }
        let mut planner = Planner { choice, calibration, stream, steps: Vec::new(), notes: Vec::new() };
        let (time, lineariser) = planner.time()?;
        let (distance, distance_table) = planner.distance()?.unzip();
        let denoise = planner.denoise(distance.is_some());
        let illumination = planner.illumination()?;
        let physics = planner.steps.iter().filter(|step| step.effect != "denoise");
        let textbook: Vec<&str> = physics.map(|step| step.term).collect();
        if calibration.is_none() && !textbook.is_empty() {
            planner.notes.insert(0, Note::Textbook { terms: textbook.join(", ") });
        }
        let specular = planner.specular();
        let sigma = planner.sigma(distance.is_some())?;
        let floor = calibration.and_then(|c| c.noise_floor).map(|floor| floor.low_signal_below_dn as f32);
        Ok(Self {
            lineariser,
            time,
            denoise,
            distance,
            distance_table: distance_table.flatten(),
            illumination,
            specular,
            sigma,
            low_signal_below_dn: choice.low_signal_below_dn.or(floor).unwrap_or(0.0),
            steps: planner.steps,
            notes: planner.notes,
        })
    }
}

struct Planner<'a> {
    choice: &'a Choice,
    calibration: Option<&'a Calibration>,
    stream: Stream,
    steps: Vec<AppliedStep>,
    notes: Vec<Note>,
}

impl Planner<'_> {
    /// A step is required when it, or the method that consists of it, was asked for by name.
    fn is_required(&self, named: bool) -> bool {
        named || self.choice.method == Method::Paper
    }

    fn has(
        &mut self,
        needed: Channels,
        effect: &'static str,
        term: &'static str,
        channel: &'static str,
        required: bool,
    ) -> Result<bool, PlanError> {
        if self.stream.channels.contains(needed) {
            return Ok(true);
        }
        if required {
            return Err(PlanError::ChannelMissing { term, channel });
        }
        self.notes.push(Note::ChannelMissing { effect, channel });
        Ok(false)
    }

    fn missing(&self, term: &'static str, fit_with: &'static str) -> PlanError {
        let holder = if self.calibration.is_some() {
            "the calibration does not hold it"
        } else {
            "no calibration is given"
        };
        PlanError::TermMissing { term, holder, fit_with }
    }

    fn step(&mut self, effect: &'static str, term: &'static str, parameters: String) {
        self.steps.push(AppliedStep { effect, term, parameters });
    }
}

#[cfg(test)]
mod tests;
