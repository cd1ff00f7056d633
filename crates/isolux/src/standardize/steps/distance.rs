//! The step that removes the effect of the distance. The loop in [`crate::standardize::kernel`] applies its
//! polynomial, flags extrapolated pixels and makes pixels without a distance INVALID; a table enters the
//! multipliers before.

use crate::advice::RecordingKind;
use crate::calibration::REFERENCE_DISTANCE_M;
use crate::frame::Channels;
use crate::standardize::planner::Planner;
use crate::standardize::report::{Note, PlanError};
use crate::step_names::{DistanceStep, Method};
use crate::terms::{DistanceLaw, eq5, square};

/// The law, and the texts that record it. The step is recorded after that of the denoising, which is planned later.
pub(crate) struct PlannedDistance {
    pub(crate) law: DistanceLaw,
    pub(crate) term: &'static str,
    pub(crate) parameters: String,
}

/// Plans the law; `None` does not scale by the distance.
///
/// # Errors
/// [`PlanError`] when something asked for by name cannot be done.
pub(crate) fn plan(planner: &mut Planner<'_>) -> Result<Option<PlannedDistance>, PlanError> {
    let named = planner.choice.distance;
    let wanted = named.unwrap_or_else(|| default_step(planner));
    if wanted == DistanceStep::None {
        return Ok(None);
    }
    let term = wanted.name();
    let required = planner.is_required(named.is_some());
    if !planner.has(Channels::DISTANCE, ["distance", term, "distance"], required)? {
        return Ok(None);
    }
    let reference_m = planner.calibration.map_or(REFERENCE_DISTANCE_M, |c| c.reference.distance_m);
    let (law, parameters) = match wanted {
        DistanceStep::Square => (square::distance_law(reference_m), format!("(d / {reference_m} m)²")),
        DistanceStep::Eq5 => {
            let parameters = format!("((2d)² + 1) / ((2·{reference_m})² + 1), d in m");
            (eq5::distance_law(reference_m), parameters)
        }
        fitted => {
            let law = planner.calibration.and_then(|calibration| calibration.terms.distance_law(fitted));
            let missing = || planner.missing(term, RecordingKind::DistanceSweep);
            let (law, [min_m, max_m]) = law.ok_or_else(missing)?;
            let valid = format!("valid from {min_m:.3} to {max_m:.3} m, d² beyond (flagged)");
            (law, format!("1 at {reference_m} m, {valid}"))
        }
    };
    Ok(Some(PlannedDistance { law, term, parameters }))
}

/// The distance step of the method; adds a note when `best` has no term for it.
fn default_step(planner: &mut Planner<'_>) -> DistanceStep {
    match (planner.choice.method, planner.calibration) {
        (Method::Paper, _) => DistanceStep::Cubic,
        (Method::Best, _) if planner.traits.already.distance => {
            planner.notes.push(Note::AlreadyCorrected { effect: "distance" });
            DistanceStep::None
        }
        (Method::Best, None) => DistanceStep::Square,
        (Method::Best, Some(calibration)) => calibration.terms.best_distance().unwrap_or_else(|| {
            if planner.traits.channels.contains(Channels::DISTANCE) {
                planner.notes.push(Note::NoDistanceTerm);
            }
            DistanceStep::None
        }),
    }
}
