//! Which materials are matt enough to share one exponent of the cosine.

use super::joint_input::JointInput;
use super::report::SurfaceUse;
use super::{TargetWarning, TargetWindows};
use crate::numerics::regression::{Intercepts, Regression, Row};
use crate::numerics::robust::Loss;

/// Windows that a material's own exponent needs.
const LEAST_WINDOWS: usize = 40;
/// A material is glossy if its exponent is larger than this by two standard errors. Paper, cloth and wall paint
/// stay below 2; black print on the boards of data sets reaches 7.
const GLOSSY: f64 = 2.5;

/// Fits each material's own exponent, its slopes over ln d, r² and ln t aside. Glossy materials are left out, unless all
/// are.
pub(super) fn judge(
    input: &JointInput,
    targets: &[TargetWindows],
    warnings: &mut Vec<TargetWarning>,
) -> Vec<SurfaceUse> {
    let mut surfaces: Vec<SurfaceUse> = (0u32..)
        .zip(&input.surfaces)
        .map(|(surface, &(recording, label))| {
            let mine: Vec<usize> =
                (0..input.observations.len()).filter(|&i| input.observations[i].surface == surface).collect();
            let exponent = exponent(input, &mine);
            SurfaceUse {
                recording: targets[recording].source.recording.clone(),
                label,
                windows: mine.len(),
                outliers: 0,
                exponent: exponent.map(|(exponent, _)| exponent),
                left_out: exponent.is_some_and(|(exponent, error)| exponent - 2.0 * error > GLOSSY),
            }
        })
        .collect();
    if surfaces.iter().all(|surface| surface.left_out) {
        surfaces.iter_mut().for_each(|surface| surface.left_out = false);
    }
    for surface in surfaces.iter().filter(|surface| surface.left_out) {
        let (recording, label) = (surface.recording.clone(), surface.label);
        let exponent = surface.exponent.unwrap_or(f64::NAN);
        warnings.push(TargetWarning::Glossy { recording, label, exponent });
    }
    surfaces
}

/// The exponent and its standard error; `None` where the windows do not determine it.
fn exponent(input: &JointInput, mine: &[usize]) -> Option<(f64, f64)> {
    let used =
        || mine.iter().map(|&i| &input.observations[i]).filter(|o| o.cosine > 0.0 && o.distance_m > 0.0);
    if used().count() < LEAST_WINDOWS {
        return None;
    }
    let varies = |value: &dyn Fn(usize) -> f64| {
        let first = mine.first().map(|&i| value(i));
        mine.iter().any(|&i| Some(value(i)) != first)
    };
    let with_time = input.model.time.is_some() && varies(&|i| f64::from(input.observations[i].time));
    let names = ["cosine", "distance", "r²", "time"];
    let count = if with_time { 4 } else { 3 };
    let mut regression = Regression::new(names[..count].iter().copied(), Intercepts::PerGroup);
    for observation in used() {
        let [x, y] = observation.place.map(f64::from);
        let time = input.levels.times_us.get(usize::from(observation.time)).map_or(0.0, |time| time.ln());
        let columns =
            [f64::from(observation.cosine).ln(), f64::from(observation.distance_m).ln(), x * x + y * y, time];
        let row = Row {
            columns: &columns[..count],
            response: f64::from(observation.ln_amplitude),
            weight: f64::from(observation.weight),
            group: 0,
            clusters: &[],
        };
        regression.push(row).ok()?;
    }
    let fit = regression.fit(Loss::Tukey).ok()?;
    fit.coefficient("cosine").map(|cosine| (cosine.value, cosine.standard_error))
}
