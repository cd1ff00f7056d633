//! The step that takes the integration time out.

use super::{Planner, TimePlan};
use crate::calibration::REFERENCE_TIME_US;
use crate::frame::Channels;
use crate::standardize::choice::{Method, TimeStep};
use crate::standardize::linearise::Lineariser;
use crate::standardize::report::{Note, PlanError};

impl Planner<'_> {
    /// The multiplier over integration time, and what is done to the amplitude before.
    pub(super) fn time(&mut self) -> Result<(TimePlan, Option<Lineariser>), PlanError> {
        let named = self.choice.time;
        let wanted = named.unwrap_or_else(|| self.default_time());
        let term = match wanted {
            TimeStep::Lut => "lut",
            TimeStep::Response => "response",
            TimeStep::Linear => "linear",
            TimeStep::None => return Ok((TimePlan::None, None)),
        };
        if !self.has(
            Channels::INTEGRATION_TIME,
            "time",
            term,
            "integration time",
            self.is_required(named.is_some()),
        )? {
            return Ok((TimePlan::None, None));
        }
        let reference_us =
            self.calibration.and_then(|c| c.reference.integration_time_us).unwrap_or(REFERENCE_TIME_US);
        match wanted {
            TimeStep::Linear => {
                self.step("time", term, format!("{reference_us} µs / t"));
                return Ok((TimePlan::Linear { reference_us }, None));
            }
            TimeStep::Response => return self.response(reference_us),
            TimeStep::Lut | TimeStep::None => {}
        }
        let lut = self.calibration.and_then(|c| c.terms.lut.clone());
        let lut = lut.ok_or_else(|| self.missing(term, "--exposure-sweep"))?;
        let [min_us, max_us] = lut.valid_integration_time_us;
        self.step("time", term, format!("1 at {reference_us} µs, valid from {min_us} to {max_us} µs"));
        Ok((TimePlan::Lut(lut), None))
    }

    /// The time step of the method; notes what `best` goes without.
    fn default_time(&mut self) -> TimeStep {
        match (self.choice.method, self.calibration) {
            (Method::Paper, _) => TimeStep::Lut,
            (Method::Best, None) => TimeStep::Linear,
            (Method::Best, Some(_)) if self.has_better_than_the_lut() => TimeStep::Response,
            (Method::Best, Some(calibration)) if calibration.terms.lut.is_some() => TimeStep::Lut,
            (Method::Best, Some(_)) => {
                if self.stream.channels.contains(Channels::INTEGRATION_TIME) {
                    let instead = "`--time linear` uses t_ref/t.";
                    self.notes.push(Note::TermMissing { term: "lut", instead });
                }
                TimeStep::None
            }
        }
    }
}
