//! Fits the terms `lut`, `response` and `noise`, and the noise floor, to exposure sweeps.

use super::tiers::{fit_response, sources};
use super::{ExposureCurve, ExposureWarning, NoiseCells};
use crate::calibrate::CalibrateSettings;
use crate::calibration::Calibration;
use crate::terms::lut::{LutAnswer, LutError, RelativeSample};
use crate::terms::{Lut, root_mean_square};

/// Why no table can be fitted to the sweeps.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::calibrate) struct TableError {
    /// The recording.
    pub(in crate::calibrate) recording: String,
    /// Why.
    pub(in crate::calibrate) source: LutError,
    /// The warnings so far.
    pub(in crate::calibrate) warnings: Vec<ExposureWarning>,
}

/// Fits every term that the sweeps (at least one) determine, and writes it into `calibration`.
pub(in crate::calibrate) fn fit(
    settings: &CalibrateSettings,
    curves: &[ExposureCurve],
    calibration: &mut Calibration,
) -> Result<Vec<ExposureWarning>, TableError> {
    let (lut, mut warnings) = fit_lut(settings, curves)?;
    let (response, missing) = fit_response(settings, curves, &lut);
    warnings.extend(missing.into_iter().map(ExposureWarning::NoTier));
    calibration.terms.lut = Some(lut);
    calibration.terms.response = response;
    let floors = curves.iter().filter_map(|curve| curve.noise_floor);
    calibration.noise_floor = floors.min_by(|a, b| a.integration_time_us.total_cmp(&b.integration_time_us));
    // Between neighbouring pixels, the texture of the scene would count as noise.
    let repeated = curves.iter().map(|curve| &curve.noise).filter(|noise| !noise.spatial);
    calibration.terms.noise = NoiseCells::merged(repeated).fit(sources(curves));
    Ok(warnings)
}

/// Fits one table per sweep and takes their geometric mean. Sweeps of different scenes differ by a factor, which
/// the normalization at the reference time removes, and in their saturation, which shows in the residual.
fn fit_lut(
    settings: &CalibrateSettings,
    curves: &[ExposureCurve],
) -> Result<(Lut, Vec<ExposureWarning>), TableError> {
    let reference_us = settings.reference_time_us();
    let (mut tables, mut warnings) = (Vec::new(), Vec::new());
    for curve in curves {
        let lut = Lut::fit(&curve.samples, reference_us).map_err(|source| {
            let (recording, warnings) = (curve.source.recording.clone(), curve.warnings.clone());
            TableError { recording, source, warnings }
        })?;
        warnings.extend(curve.warnings_for(&lut));
        tables.push(lut);
    }
    let lut = match tables.as_slice() {
        [single] => single.clone(),
        several => Lut::of_curve(&mean_curve(several), reference_us).map_err(|source| {
            let (recording, warnings) = ("(all together)".to_owned(), warnings.clone());
            TableError { recording, source, warnings }
        })?,
    };
    let words = warnings.iter().map(ToString::to_string).collect();
    Ok((lut.with_origin(sources(curves), words), warnings))
}

/// Mean curve of several tables, 1 at the reference, at all of their times that every table covers. All tables are
/// interpolated at each of these times, so that the mean is always over all sweeps.
fn mean_curve(tables: &[Lut]) -> Vec<RelativeSample> {
    let mut times: Vec<f64> = tables.iter().flat_map(|lut| lut.integration_time_us.iter().copied()).collect();
    times.sort_by(f64::total_cmp);
    times.dedup();
    let sample = |integration_time_us: f64| {
        let logs: Option<Vec<f64>> = tables
            .iter()
            .map(|lut| match lut.at(integration_time_us) {
                LutAnswer::Inside(multiplier) => Some(-multiplier.ln()),
                LutAnswer::Below(_) | LutAnswer::Refused => None,
            })
            .collect();
        let logs = logs?;
        let mean = logs.iter().sum::<f64>() / logs.len() as f64;
        let spread = root_mean_square(logs.iter().map(|log| log - mean)).unwrap_or(0.0);
        Some(RelativeSample { integration_time_us, relative_amplitude: mean.exp(), spread })
    };
    times.into_iter().filter_map(sample).collect()
}
