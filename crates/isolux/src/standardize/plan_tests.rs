//! What each choice becomes.

use super::*;
use crate::calibration::Reference;
use crate::choice::DenoiseStep;
use crate::step_names::{DistanceStep, Method, TimeStep};

const BOTH: Channels = Channels::INTEGRATION_TIME.union(Channels::DISTANCE).union(Channels::AMPLITUDE);

fn terms(plan: &Plan) -> Vec<&str> {
    plan.steps.iter().map(|step| step.term).collect()
}

#[test]
fn without_a_calibration_the_steps_are_textbook_and_say_so() {
    let plan = Plan::new(&Choice::default(), None, BOTH.into()).unwrap();
    assert_eq!(terms(&plan), ["linear", "square", "histogram"]);
    assert_eq!(plan.notes, [Note::Textbook { terms: "linear, square".to_owned() }]);
}

#[test]
fn channels_that_are_not_there_are_skipped_with_a_note_or_refused_by_name() {
    let plan = Plan::new(&Choice::default(), None, Channels::AMPLITUDE.into()).unwrap();
    assert_eq!(terms(&plan), ["histogram"]);
    assert_eq!(plan.notes.len(), 2);
    let named = Choice { distance: Some(DistanceStep::Eq5), ..Choice::default() };
    let error = Plan::new(&named, None, Channels::AMPLITUDE.into()).unwrap_err();
    assert_eq!(error, PlanError::ChannelMissing { term: "eq5", channel: "distance" });
}

#[test]
fn terms_that_the_calibration_lacks_are_notes_for_best_and_errors_by_name() {
    let empty = Calibration::new(None, Reference::default());
    let plan = Plan::new(&Choice::default(), Some(&empty), BOTH.into()).unwrap();
    assert_eq!(terms(&plan), ["histogram"]);
    assert_eq!(plan.notes, [Note::NoTimeTerm, Note::NoDistanceTerm]);
    for choice in [
        Choice { method: Method::Paper, ..Choice::default() },
        Choice { time: Some(TimeStep::Lut), ..Choice::default() },
    ] {
        let error = Plan::new(&choice, Some(&empty), BOTH.into()).unwrap_err();
        assert!(matches!(error, PlanError::TermMissing { term: "lut", .. }));
    }
}

#[test]
fn denoising_goes_before_the_distance_and_only_with_it() {
    let denoise = Some(DenoiseStep::Smooth(DenoiseRule::Wiener));
    let plan = Plan::new(&Choice { denoise, ..Choice::default() }, None, BOTH.into()).unwrap();
    assert_eq!(terms(&plan), ["linear", "wiener", "square", "histogram"]);
    let without = Choice { denoise, distance: Some(DistanceStep::None), ..Choice::default() };
    let plan = Plan::new(&without, None, BOTH.into()).unwrap();
    assert_eq!((terms(&plan), plan.denoise), (vec!["linear", "histogram"], None));
    assert_eq!(plan.notes.last(), Some(&Note::NothingToDenoise));
}

#[test]
fn a_spoilt_calibration_is_refused() {
    let mut calibration = Calibration::new(None, Reference::default());
    calibration.reference.distance_m = f64::NAN;
    assert!(Plan::new(&Choice::default(), Some(&calibration), BOTH.into()).is_err());
}
