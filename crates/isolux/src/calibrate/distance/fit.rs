//! Fits the terms `cubic` and `spline` to reference decays.

use super::{DistanceWarning, ReferenceDecays, ambient};
use crate::calibrate::CalibrateSettings;
use crate::calibration::Calibration;
use crate::terms::cubic::{CubicError, Decay, DecayUse, Scaling};
use crate::terms::spline::SplineUse;
use crate::terms::{Cubic, Source, Spline};

/// With fewer positions, a fit follows the noise of the decay.
const ENOUGH_POSITIONS: usize = 8;
/// A decay with a larger share of outliers contradicts the others.
const MANY_OUTLIERS: f64 = 1.0 / 3.0;

/// What the fit found.
pub(in crate::calibrate) struct DistanceFit {
    pub(in crate::calibrate) decays: Vec<(Decay, DecayUse)>,
    /// How the spline used each of its decays; empty without a spline.
    pub(in crate::calibrate) spline_uses: Vec<SplineUse>,
    pub(in crate::calibrate) warnings: Vec<DistanceWarning>,
}

/// The decays, sources and warnings of several sweeps.
struct Pooled {
    sources: Vec<Source>,
    decays: Vec<Decay>,
    warnings: Vec<DistanceWarning>,
}

impl Pooled {
    fn of(sweeps: Vec<ReferenceDecays>) -> Self {
        let mut pooled = Self { sources: Vec::new(), decays: Vec::new(), warnings: Vec::new() };
        for sweep in sweeps {
            pooled.sources.push(sweep.source);
            pooled.decays.extend(sweep.decays);
            pooled.warnings.extend(sweep.warnings);
        }
        pooled
    }
}

/// Fits cubic, spline and the response by amplitude and distance, and writes them into `calibration`: the cubic to the
/// frames as delivered, the spline to `linear` frames where there are any, else to amplitudes that this response makes
/// linear, else to the frames as delivered. Only the cubic must be determined; the others give a warning.
///
/// # Errors
/// Why there is no cubic, with the warnings so far.
pub(in crate::calibrate) fn fit(
    settings: &CalibrateSettings,
    delivered: Vec<ReferenceDecays>,
    linear: Vec<ReferenceDecays>,
    calibration: &mut Calibration,
) -> Result<DistanceFit, (CubicError, Vec<DistanceWarning>)> {
    let ambient = ambient::fit(settings, &delivered);
    let Pooled { sources, decays, warnings: about_sweeps } = Pooled::of(delivered);
    let reference_m = settings.reference.distance_m;
    let (cubic, uses) = Cubic::fit(&decays, reference_m).map_err(|source| (source, about_sweeps.clone()))?;
    let mut warnings = about_sweeps.clone();
    warnings.extend(about_decays(&decays, &uses));
    calibration.terms.cubic = Some(cubic.with_origin(sources.clone(), words(&warnings)));
    let linear = Pooled::of(linear);
    for warning in linear.warnings {
        // Most warnings hold for both measurements.
        if !warnings.iter().any(|known| known.repeats(&warning)) {
            warnings.push(warning);
        }
    }
    let by_ambient = match ambient {
        Ok(response) => {
            let linear = ambient::linear(&response, &decays);
            ambient::keep(settings, response, calibration);
            linear
        }
        Err(reason) => {
            warnings.push(DistanceWarning::NoAmbient { reason });
            Vec::new()
        }
    };
    let candidates = [&linear.decays, &by_ambient, &decays];
    let smooth = candidates.into_iter().find(|decays| !decays.is_empty()).unwrap_or(&decays);
    let mut spline_uses = Vec::new();
    match Spline::fit(smooth, reference_m, settings.modulation_frequency_hz) {
        Ok((spline, uses)) => {
            let outliers = about_outliers(smooth, &uses);
            let words = words(about_sweeps.iter().chain(&outliers));
            calibration.terms.spline = Some(spline.with_origin(sources, words));
            warnings.extend(outliers);
            spline_uses = uses;
        }
        Err(reason) => warnings.push(DistanceWarning::NoSpline { reason }),
    }
    Ok(DistanceFit { decays: decays.into_iter().zip(uses).collect(), spline_uses, warnings })
}

fn words<'a>(warnings: impl IntoIterator<Item = &'a DistanceWarning>) -> Vec<String> {
    warnings.into_iter().map(ToString::to_string).collect()
}

fn about_decays(decays: &[Decay], uses: &[DecayUse]) -> Vec<DistanceWarning> {
    let mut warnings = Vec::new();
    for (decay, used) in decays.iter().zip(uses) {
        let integration_time_us = decay.integration_time_us;
        if used.scaling == Scaling::LeftOut {
            warnings.push(DistanceWarning::NoOverlap { integration_time_us });
        } else if decay.points.len() < ENOUGH_POSITIONS {
            let found = decay.points.len();
            warnings.push(DistanceWarning::TooFewDistances { integration_time_us, found });
        }
    }
    warnings
}

fn about_outliers(decays: &[Decay], uses: &[SplineUse]) -> Vec<DistanceWarning> {
    let many = |(decay, used): &(&Decay, &SplineUse)| {
        used.outliers as f64 > MANY_OUTLIERS * decay.points.len() as f64
    };
    let warning = |(decay, used): (&Decay, &SplineUse)| DistanceWarning::Outliers {
        integration_time_us: decay.integration_time_us,
        outliers: used.outliers,
        positions: decay.points.len(),
    };
    decays.iter().zip(uses).filter(many).map(warning).collect()
}
