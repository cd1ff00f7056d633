//! The step that takes the distance out.

use super::Planner;
use crate::calibration::REFERENCE_DISTANCE_M;
use crate::frame::Channels;
use crate::standardize::choice::{DistanceStep, Method};
use crate::standardize::report::{Note, PlanError};
use crate::terms::{DistanceGain, DistanceTable, Spline, eq5, square};

impl Planner<'_> {
    pub(super) fn distance(&mut self) -> Result<Option<(DistanceGain, Option<DistanceTable>)>, PlanError> {
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
                (gain, Some(table), fitted(spline.law.valid_distance_m))
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

    /// The distance step of the method; notes what `best` goes without.
    fn default_distance(&mut self) -> DistanceStep {
        match (self.choice.method, self.calibration) {
            (Method::Paper, _) => DistanceStep::Cubic,
            (Method::Best, None) => DistanceStep::Square,
            (Method::Best, Some(calibration)) if calibration.terms.spline.is_some() => DistanceStep::Spline,
            (Method::Best, Some(calibration)) if calibration.terms.cubic.is_some() => DistanceStep::Cubic,
            (Method::Best, Some(_)) => {
                if self.stream.channels.contains(Channels::DISTANCE) {
                    let instead = "`--distance square` uses d².";
                    self.notes.push(Note::TermMissing { term: "cubic", instead });
                }
                DistanceStep::None
            }
        }
    }
}
