//! The record of how a recording was standardized.

use isolux::standardize::AppliedStep;
use isolux::{Calibration, PixelFlags, Reference, Standardizer};
use isolux_io::RecordingInfo;
use serde_json::{Map, Value, json};

use crate::brackets::Brackets;
use crate::source::SourceFacts;

/// The field of a standardized recording's description that holds the record.
pub const PROVENANCE: &str = "standardization";

/// The steps of a chain, in their order: highlights are limited after merging.
#[must_use]
pub fn steps(standardizer: &Standardizer, brackets: Option<&Brackets>) -> Vec<AppliedStep> {
    let mut steps = standardizer.steps().to_vec();
    if let Some(brackets) = brackets {
        let place = steps.iter().position(|step| step.effect == "specular").unwrap_or(steps.len());
        let parameters = brackets.describe();
        steps.insert(place, AppliedStep { effect: "merge", term: "bracket", parameters });
    }
    steps
}

/// A step as JSON has it.
#[must_use]
pub fn step_json(step: &AppliedStep) -> Value {
    json!({"effect": step.effect, "term": step.term, "parameters": step.parameters})
}

/// What is known of the input, and what was done to it.
pub(super) fn record(
    facts: &SourceFacts,
    standardizer: &Standardizer,
    brackets: Option<&Brackets>,
    calibration: Option<&Calibration>,
) -> RecordingInfo {
    let legend: Map<String, Value> =
        PixelFlags::legend().map(|(name, bit)| (name.to_owned(), Value::from(bit))).collect();
    let notes: Vec<String> = standardizer.notes().iter().map(ToString::to_string).collect();
    let mut info = facts.info.clone();
    if brackets.is_some() {
        // A merged frame has no integration time.
        info.integration_time_us = None;
    }
    info.other.insert(
        PROVENANCE.to_owned(),
        json!({
            "program": concat!("isolux ", env!("CARGO_PKG_VERSION")),
            "input": facts.name,
            "calibrated_camera": calibration.map(|c| c.camera.clone()),
            "reference": calibration.map_or_else(Reference::default, |c| c.reference),
            "steps": steps(standardizer, brackets).iter().map(step_json).collect::<Vec<_>>(),
            "notes": notes,
            "flag_bits": legend,
        }),
    );
    info
}
