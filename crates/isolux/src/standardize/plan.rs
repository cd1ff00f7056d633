//! From the user's choice, the calibration and the channels at hand to the steps that will be applied.

use super::choice::{Choice, DenoiseStep, DistanceStep, Method, SpecularStep, TimeStep};
use super::report::{AppliedStep, Note, PlanError};
use crate::calibration::{Calibration, REFERENCE_DISTANCE_M, REFERENCE_TIME_US};
use crate::denoise::DenoiseRule;
use crate::frame::Channels;
use crate::specular::{HistogramRule, SpecularRule};
use crate::terms::{DistanceGain, DistanceTable, Lut, Spline, eq5, square};

/// The integration-time step, ready to apply.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum TimePlan {
    Lut(Lut),
    Linear { reference_us: f64 },
    None,
}

/// Everything that depends on the calibration alone.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Plan {
    pub(super) time: TimePlan,
    /// `None` scales by the distance as delivered.
    pub(super) denoise: Option<DenoiseRule>,
    /// `None` leaves the distance in.
    pub(super) distance: Option<DistanceGain>,
    /// A factor on that law, for laws that are no polynomial.
    pub(super) distance_table: Option<DistanceTable>,
    pub(super) specular: Option<SpecularRule>,
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
        available: Channels,
    ) -> Result<Self, PlanError> {
        if let Some(calibration) = calibration {
            calibration.check()?;
        }
        let mut planner = Planner { choice, calibration, available, steps: Vec::new(), notes: Vec::new() };
        let time = planner.time()?;
        let (distance, distance_table) = planner.distance()?.unzip();
        let textbook: Vec<&str> = planner.steps.iter().map(|step| step.term).collect();
        if calibration.is_none() && !textbook.is_empty() {
            planner.notes.insert(0, Note::Textbook { terms: textbook.join(", ") });
        }
        let denoise = planner.denoise(distance.is_some());
        let specular = planner.specular();
        let floor = calibration.and_then(|c| c.noise_floor).map(|floor| floor.low_signal_below_dn as f32);
        Ok(Self {
            time,
            denoise,
            distance,
            distance_table: distance_table.flatten(),
            specular,
            low_signal_below_dn: choice.low_signal_below_dn.or(floor).unwrap_or(0.0),
            steps: planner.steps,
            notes: planner.notes,
        })
    }
}

struct Planner<'a> {
    choice: &'a Choice,
    calibration: Option<&'a Calibration>,
    available: Channels,
    steps: Vec<AppliedStep>,
    notes: Vec<Note>,
}

impl Planner<'_> {
    fn time(&mut self) -> Result<TimePlan, PlanError> {
        let named = self.choice.time;
        let wanted = named.unwrap_or_else(|| self.default_time());
        let term = match wanted {
            TimeStep::Lut => "lut",
            TimeStep::Linear => "linear",
            TimeStep::None => return Ok(TimePlan::None),
        };
        if !self.has(
            Channels::INTEGRATION_TIME,
            "time",
            term,
            "integration time",
            self.is_required(named.is_some()),
        )? {
            return Ok(TimePlan::None);
        }
        let reference_us =
            self.calibration.and_then(|c| c.reference.integration_time_us).unwrap_or(REFERENCE_TIME_US);
        if wanted == TimeStep::Linear {
            self.step("time", term, format!("{reference_us} µs / t"));
            return Ok(TimePlan::Linear { reference_us });
        }
        let lut = self.calibration.and_then(|c| c.terms.lut.clone());
        let lut = lut.ok_or_else(|| self.missing(term, "--exposure-sweep"))?;
        let [min_us, max_us] = lut.valid_integration_time_us;
        self.step("time", term, format!("1 at {reference_us} µs, valid from {min_us} to {max_us} µs"));
        Ok(TimePlan::Lut(lut))
    }

    fn distance(&mut self) -> Result<Option<(DistanceGain, Option<DistanceTable>)>, PlanError> {
        let named = self.choice.distance;
        let wanted = named.unwrap_or_else(|| self.default_distance());
        let term = match wanted {
            DistanceStep::Cubic => "cubic",
            DistanceStep::Spline => "spline",
            DistanceStep::Square => "square",
            DistanceStep::Eq5 => "eq5",
            DistanceStep::None => return Ok(None),
        };
        if !self.has(Channels::DISTANCE, "distance", term, "distance", self.is_required(named.is_some()))? {
            return Ok(None);
        }
        let reference_m = self.calibration.map_or(REFERENCE_DISTANCE_M, |c| c.reference.distance_m);
        let fitted = |[min_m, max_m]: [f64; 2]| {
            format!("1 at {reference_m} m, valid from {min_m:.3} to {max_m:.3} m, d² beyond (flagged)")
        };
        let terms = self.calibration.map(|calibration| &calibration.terms);
        let (gain, table, parameters) = match wanted {
            DistanceStep::Square => (square::gain(reference_m), None, format!("(d / {reference_m} m)²")),
            DistanceStep::Eq5 => {
                (eq5::gain(reference_m), None, format!("((2d)² + 1) / ((2·{reference_m})² + 1), d in m"))
            }
            DistanceStep::Spline => {
                let spline = terms.and_then(|terms| terms.spline.as_ref());
                let spline: &Spline = spline.ok_or_else(|| self.missing(term, "--distance-sweep"))?;
                let (gain, table) = spline.gain();
                (gain, Some(table), fitted(spline.valid_distance_m))
            }
            DistanceStep::Cubic | DistanceStep::None => {
                let cubic = terms.and_then(|terms| terms.cubic.as_ref());
                let cubic = cubic.ok_or_else(|| self.missing(term, "--distance-sweep"))?;
                (cubic.gain(), None, fitted(cubic.valid_distance_m))
            }
        };
        self.step("distance", term, parameters);
        Ok(Some((gain, table)))
    }

    /// Its step goes before that of the distance, which is planned already.
    fn denoise(&mut self, distance_scales: bool) -> Option<DenoiseRule> {
        let Some(DenoiseStep::Smooth(rule)) = self.choice.denoise else { return None };
        if !distance_scales {
            self.notes.push(Note::NothingToDenoise);
            return None;
        }
        let step = AppliedStep { effect: "denoise", term: rule.name(), parameters: rule.parameters() };
        self.steps.insert(self.steps.len() - 1, step);
        Some(rule)
    }

    fn specular(&mut self) -> Option<SpecularRule> {
        let default = SpecularStep::Limit(SpecularRule::Histogram(HistogramRule::default()));
        let SpecularStep::Limit(rule) = self.choice.specular.unwrap_or(default) else { return None };
        self.step("specular", rule.name(), rule.parameters());
        Some(rule)
    }

    /// The time step of the method; notes what `best` goes without.
    fn default_time(&mut self) -> TimeStep {
        match (self.choice.method, self.calibration) {
            (Method::Paper, _) => TimeStep::Lut,
            (Method::Best, None) => TimeStep::Linear,
            (Method::Best, Some(calibration)) if calibration.terms.lut.is_some() => TimeStep::Lut,
            (Method::Best, Some(_)) => {
                if self.available.contains(Channels::INTEGRATION_TIME) {
                    let instead = "`--time linear` uses t_ref/t.";
                    self.notes.push(Note::TermMissing { term: "lut", instead });
                }
                TimeStep::None
            }
        }
    }

    /// The distance step of the method; notes what `best` goes without.
    fn default_distance(&mut self) -> DistanceStep {
        match (self.choice.method, self.calibration) {
            (Method::Paper, _) => DistanceStep::Cubic,
            (Method::Best, None) => DistanceStep::Square,
            (Method::Best, Some(calibration)) if calibration.terms.spline.is_some() => DistanceStep::Spline,
            (Method::Best, Some(calibration)) if calibration.terms.cubic.is_some() => DistanceStep::Cubic,
            (Method::Best, Some(_)) => {
                if self.available.contains(Channels::DISTANCE) {
                    let instead = "`--distance square` uses d².";
                    self.notes.push(Note::TermMissing { term: "cubic", instead });
                }
                DistanceStep::None
            }
        }
    }

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
        if self.available.contains(needed) {
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
mod tests {
    use super::*;
    use crate::calibration::Reference;

    const BOTH: Channels = Channels::INTEGRATION_TIME.union(Channels::DISTANCE).union(Channels::AMPLITUDE);

    fn terms(plan: &Plan) -> Vec<&str> {
        plan.steps.iter().map(|step| step.term).collect()
    }

    #[test]
    fn without_a_calibration_the_steps_are_textbook_and_say_so() {
        let plan = Plan::new(&Choice::default(), None, BOTH).unwrap();
        assert_eq!(terms(&plan), ["linear", "square", "histogram"]);
        assert_eq!(plan.notes, [Note::Textbook { terms: "linear, square".to_owned() }]);
    }

    #[test]
    fn channels_that_are_not_there_are_skipped_with_a_note_or_refused_by_name() {
        let plan = Plan::new(&Choice::default(), None, Channels::AMPLITUDE).unwrap();
        assert_eq!(terms(&plan), ["histogram"]);
        assert_eq!(plan.notes.len(), 2);
        let named = Choice { distance: Some(DistanceStep::Eq5), ..Choice::default() };
        let error = Plan::new(&named, None, Channels::AMPLITUDE).unwrap_err();
        assert_eq!(error, PlanError::ChannelMissing { term: "eq5", channel: "distance" });
    }

    #[test]
    fn terms_that_the_calibration_lacks_are_notes_for_best_and_errors_by_name() {
        let empty = Calibration::new(None, Reference::default());
        let plan = Plan::new(&Choice::default(), Some(&empty), BOTH).unwrap();
        assert_eq!(terms(&plan), ["histogram"]);
        assert!(matches!(
            plan.notes[..],
            [Note::TermMissing { term: "lut", .. }, Note::TermMissing { term: "cubic", .. }]
        ));
        for choice in [
            Choice { method: Method::Paper, ..Choice::default() },
            Choice { time: Some(TimeStep::Lut), ..Choice::default() },
        ] {
            let error = Plan::new(&choice, Some(&empty), BOTH).unwrap_err();
            assert!(matches!(error, PlanError::TermMissing { term: "lut", .. }));
        }
    }

    #[test]
    fn denoising_goes_before_the_distance_and_only_with_it() {
        let denoise = Some(DenoiseStep::Smooth(DenoiseRule::Wiener));
        let plan = Plan::new(&Choice { denoise, ..Choice::default() }, None, BOTH).unwrap();
        assert_eq!(terms(&plan), ["linear", "wiener", "square", "histogram"]);
        let without = Choice { denoise, distance: Some(DistanceStep::None), ..Choice::default() };
        let plan = Plan::new(&without, None, BOTH).unwrap();
        assert_eq!((terms(&plan), plan.denoise), (vec!["linear", "histogram"], None));
        assert_eq!(plan.notes.last(), Some(&Note::NothingToDenoise));
    }

    #[test]
    fn a_spoilt_calibration_is_refused() {
        let mut calibration = Calibration::new(None, Reference::default());
        calibration.reference.distance_m = f64::NAN;
        assert!(Plan::new(&Choice::default(), Some(&calibration), BOTH).is_err());
    }
}
