//! Refuses factors that depend on the angle's exponent where the observations do not determine it.
//!
//! The normals of a scene are measured, with errors. Where cosθ changes within surfaces by little more than these
//! errors, the noise of the normals leads to a wrong exponent, and with it to a wrong profile. The exponent is then
//! fixed, at two values in turn: a factor that differs between the two fits is confounded with it.

use super::joint_input::JointInput;
use crate::calibrate::joint::{self, AngleModel, Factor, Finding, JointError, JointFit, JointModel, Refusal};
use crate::terms::angle::LAMBERT;
use crate::terms::profile::Places;
use crate::terms::root_mean_square;

/// A factor is refused if it changes by more than this in ln (root mean square) when the exponent changes by 1.
const LARGEST_CHANGE: f64 = 0.02;

/// Fits the input. Where the exponent is refused, it is fixed at Lambert's 1, and factors that depend on it are
/// refused too.
pub(super) fn settle(input: &JointInput) -> Result<JointFit, JointError> {
    let free = joint::solve(&input.observations, &input.model)?;
    let Some(finding) = free.findings.iter().find(|finding| finding.factor == Factor::Angle) else {
        return Ok(free);
    };
    if finding.refusal.is_none() {
        return Ok(free);
    }
    let held = |exponent: f64| {
        let model = JointModel { angle: AngleModel::Fixed(exponent), ..input.model };
        joint::solve(&input.observations, &model)
    };
    let (mut fit, other) = (held(LAMBERT)?, held(LAMBERT - 1.0)?);
    for (factor, change) in
        [(Factor::Distance, law_change(&fit, &other)), (Factor::Profile, profile_change(&fit, &other))]
    {
        refuse(&mut fit.findings, factor, change);
    }
    let told = |factor| fit.refusal(factor).is_none();
    let (law, profile) = (told(Factor::Distance), told(Factor::Profile));
    fit.distance = fit.distance.filter(|_| law);
    fit.profile = fit.profile.filter(|_| profile);
    fit.findings.push(finding.clone());
    Ok(fit)
}

fn refuse(findings: &mut [Finding], factor: Factor, change: Option<f64>) {
    let Some(change) = change.filter(|change| *change > LARGEST_CHANGE) else { return };
    for finding in findings.iter_mut().filter(|finding| finding.factor == factor && finding.refusal.is_none())
    {
        finding.inflation = finding.inflation.max(change / finding.standard_error);
        let (with, inflation) = (vec![Factor::Angle], finding.inflation);
        finding.refusal = Some(Refusal::Confounded { factor, with, inflation });
    }
}

/// Change of ln h over the observed distances; `None` where it is refused anyway.
fn law_change(fit: &JointFit, other: &JointFit) -> Option<f64> {
    const STEPS: u32 = 32;
    let (law, other) = (fit.distance.as_ref()?, other.distance.as_ref()?);
    let [min_m, max_m] = law.valid_distance_m;
    let distances = (0..=STEPS).map(|i| min_m * (max_m / min_m).powf(f64::from(i) / f64::from(STEPS)));
    root_mean_square(distances.map(|d| law.ln_response(d) - other.ln_response(d)))
}

/// Change of ln v over the cells that were seen.
fn profile_change(fit: &JointFit, other: &JointFit) -> Option<f64> {
    let (profile, other) = (fit.profile.as_ref()?, other.profile.as_ref()?);
    let cells = (0..Places::CELLS[0] * Places::CELLS[1]).filter(|&cell| profile.cell_errors[cell].is_some());
    root_mean_square(cells.map(|cell| {
        let place = profile.map.places.cell_centre(cell);
        profile.map.ln_gain(place) - other.map.ln_gain(place)
    }))
}
