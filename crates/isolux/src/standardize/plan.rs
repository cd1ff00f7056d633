//! Decides the steps that will be applied, from the user's choice, the calibration and the recording's traits.

use super::other_camera;
use super::planner::Planner;
use super::recording_traits::RecordingTraits;
use super::report::{AppliedStep, Note, PlanError};
use super::steps::angle::{self, AnglePlan};
use super::steps::response::SaturationCorrection;
use super::steps::sigma::{self, SigmaPlan};
use super::steps::time::{self, TimePlan};
use super::steps::{denoise, distance, profile, specular};
use crate::calibration::Calibration;
use crate::choice::Choice;
use crate::denoise::DenoiseRule;
use crate::frame::Channels;
use crate::specular::SpecularRule;
use crate::step_names::TimeStep;
use crate::terms::DistanceLaw;
use crate::terms::profile::ProfileGains;

/// Everything that can be computed before the first frame. A step that is `None` is left out.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Plan {
    pub(super) saturation: Option<SaturationCorrection>,
    pub(super) time: TimePlan,
    pub(super) denoise: Option<DenoiseRule>,
    pub(super) distance: Option<DistanceLaw>,
    pub(super) profile: Option<ProfileGains>,
    pub(super) angle: Option<AnglePlan>,
    pub(super) specular: Option<SpecularRule>,
    pub(super) sigma: Option<SigmaPlan>,
    pub(super) low_signal_below_dn: f32,
    pub(super) steps: Vec<AppliedStep>,
    pub(super) notes: Vec<Note>,
}

impl Plan {
    /// Decides each step.
    ///
    /// # Errors
    /// [`PlanError`] when something asked for by name cannot be done.
    pub(super) fn new(
        choice: &Choice,
        calibration: Option<&Calibration>,
        traits: RecordingTraits,
    ) -> Result<Self, PlanError> {
        if let Some(calibration) = calibration {
            calibration.check()?;
        }
        let mut planner = Planner::new(choice, calibration, traits);
        let (time, saturation) = time::plan(&mut planner)?;
        let distance = distance::plan(&mut planner)?;
        let denoise = denoise::plan(&mut planner, distance.is_some());
        let distance = distance.map(|planned| {
            planner.step("distance", planned.term, planned.parameters);
            planned.law
        });
        let profile = profile::plan(&mut planner)?;
        let angle = angle::plan(&mut planner)?;
        note_textbook(&mut planner);
        other_camera::note(&mut planner);
        let specular = specular::plan(&mut planner);
        let sigma = sigma::plan(&mut planner, distance.is_some())?;
        let floor = calibration.and_then(|c| c.noise_floor).map(|floor| floor.low_signal_below_dn as f32);
        Ok(Self {
            saturation,
            time,
            denoise,
            distance,
            profile,
            angle,
            specular,
            sigma,
            low_signal_below_dn: choice.low_signal_below_dn.or(floor).unwrap_or(0.0),
            steps: planner.steps,
            notes: planner.notes,
        })
    }

    /// Channels that the chain reads.
    pub(super) fn needed(&self) -> Channels {
        let mut needed = Channels::AMPLITUDE;
        needed.set(Channels::INTEGRATION_TIME, self.time.reads_time());
        needed.set(Channels::DISTANCE, self.distance.is_some() || self.angle.is_some());
        needed
            | self.saturation.as_ref().map_or(Channels::empty(), SaturationCorrection::channels)
            | self.sigma.map_or(Channels::empty(), |sigma| sigma.needed)
    }
}

/// Puts a note before all others: the planned steps are textbook physics and no calibration.
fn note_textbook(planner: &mut Planner<'_>) {
    let relative = TimeStep::Relative.name();
    let physics = planner.steps.iter().filter(|step| step.effect != "denoise" && step.term != relative);
    let terms: Vec<&str> = physics.map(|step| step.term).collect();
    if planner.calibration.is_none() && !terms.is_empty() {
        planner.notes.insert(0, Note::Textbook { terms: terms.join(", ") });
    }
}

#[cfg(test)]
#[path = "plan_tests.rs"]
mod tests;
