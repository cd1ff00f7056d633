//! From measurements to terms, in two stages: what the integration time does, then everything that is fitted to linear
//! amplitudes.

use super::{
    CalibrateError, CalibrateSettings, ExposureCurve, FitWarning, NoiseCells, ReferenceDecays,
    SceneObservations, SceneReport, TargetReport, TargetWindows, response, scene, target, warning,
};
use crate::calibration::Calibration;
use crate::terms::cubic::{Decay, DecayUse};
use crate::terms::lut::{ExposureSample, LutAnswer};
use crate::terms::spline::SplineUse;
use crate::terms::{Cubic, Lut, Response, Spline};

/// What the fits found, for the user to judge them.
#[derive(Clone, Debug, PartialEq)]
pub struct FitReport {
    /// Exposure samples of each exposure sweep.
    pub exposure_curves: Vec<ExposureCurve>,
    /// Reference decays as they entered the cubic, with what became of them.
    pub decays: Vec<(Decay, DecayUse)>,
    /// What became of the decays that the spline was fitted on; empty where there is none.
    pub spline_uses: Vec<SplineUse>,
    /// What the fit of targets found.
    pub target: Option<TargetReport>,
    /// What the fit of scenes found.
    pub scene: Option<SceneReport>,
    /// Everything that the user should know or record better, also in the calibration's terms.
    pub warnings: Vec<FitWarning>,
}

/// Measured recordings of what the time does not tell, by what they are.
#[derive(Clone, Debug, Default)]
pub struct Measurements {
    /// A flat target at several distances, as it was delivered: the paper's cubic is fitted on it.
    pub distance_sweeps: Vec<ReferenceDecays>,
    /// The same sweeps after [`FrameLineariser`](crate::standardize::FrameLineariser), where the response allows it: the
    /// spline is then fitted on these.
    pub linear_distance_sweeps: Vec<ReferenceDecays>,
    /// Labelled targets in any pose, linear where the response allows it.
    pub targets: Vec<TargetWindows>,
    /// Ordinary recordings.
    pub scenes: Vec<SceneObservations>,
}

/// What exposure sweeps determine: the first stage of a calibration, since whatever is fitted after it needs the
/// response to be linear.
#[derive(Clone, Debug)]
pub struct ExposureFit {
    calibration: Calibration,
    curves: Vec<ExposureCurve>,
    warnings: Vec<FitWarning>,
}

/// Fits every term that the sweeps determine.
///
/// # Errors
/// [`CalibrateError`] when no sweep is given or a term cannot be fitted from what is there.
pub fn fit(
    settings: &CalibrateSettings,
    camera: Option<String>,
    exposure_curves: Vec<ExposureCurve>,
    distance_sweeps: Vec<ReferenceDecays>,
) -> Result<(Calibration, FitReport), CalibrateError> {
    let measured = Measurements { distance_sweeps, ..Measurements::default() };
    ExposureFit::new(settings, exposure_curves)?.and(settings, camera, measured)
}

impl ExposureFit {
    /// Fits every term that exposure sweeps determine; without one, none.
    ///
    /// # Errors
    /// [`CalibrateError::Lut`] when a sweep has no table.
    pub fn new(settings: &CalibrateSettings, curves: Vec<ExposureCurve>) -> Result<Self, CalibrateError> {
        let mut calibration = Calibration::new(None, settings.reference);
        let mut warnings = Vec::new();
        if curves.is_empty() {
            // Nothing says what the amplitudes of another time would be.
            calibration.reference.integration_time_us = None;
            return Ok(Self { calibration, curves, warnings });
        }
        let lut = fit_lut(settings, &curves, &mut warnings)?;
        calibration.terms.response = response::fit_response(settings, &curves, &lut, &mut warnings);
        calibration.terms.lut = Some(lut);
        let floors = curves.iter().filter_map(|curve| curve.noise_floor);
        calibration.noise_floor =
            floors.min_by(|a, b| a.integration_time_us.total_cmp(&b.integration_time_us));
        let sources = curves.iter().map(|curve| curve.source.clone()).collect();
        // A wall's texture would pass for noise.
        let repeated = curves.iter().map(|curve| &curve.noise).filter(|noise| !noise.spatial);
        calibration.terms.noise = NoiseCells::merged(repeated).fit(sources);
        Ok(Self { calibration, curves, warnings })
    }

    /// The response that was fitted.
    #[must_use]
    pub fn response(&self) -> Option<&Response> {
        self.calibration.terms.response.as_ref()
    }

    /// Fits every other term that the recordings determine, for the camera of this name.
    ///
    /// # Errors
    /// [`CalibrateError`] when no recording is given or a term cannot be fitted from what is there.
    pub fn and(
        self,
        settings: &CalibrateSettings,
        camera: Option<String>,
        measured: Measurements,
    ) -> Result<(Calibration, FitReport), CalibrateError> {
        let Self { mut calibration, curves, warnings } = self;
        calibration.camera = camera;
        let Measurements { distance_sweeps, linear_distance_sweeps, targets, scenes } = measured;
        let sweeps = curves.len() + distance_sweeps.len();
        if sweeps + targets.len() + scenes.len() == 0 {
            return Err(CalibrateError::NothingToFit);
        }
        let mut report = FitReport {
            exposure_curves: curves,
            decays: Vec::new(),
            spline_uses: Vec::new(),
            target: None,
            scene: None,
            warnings,
        };
        if !distance_sweeps.is_empty() {
            fit_distance(settings, distance_sweeps, linear_distance_sweeps, &mut calibration, &mut report)?;
        }
        if !targets.is_empty() {
            let found = target::fit(settings, &targets, &mut calibration, &mut report.warnings)?;
            report.target = Some(found);
        }
        if !scenes.is_empty() {
            report.scene = Some(scene::fit(settings, &scenes, &mut calibration, &mut report.warnings)?);
        }
        Ok((calibration, report))
    }
}

/// One table per sweep, then their geometric mean. Sweeps at unlike walls differ by a factor, which the normalization
/// at the reference time takes out, and in their compression, which shows in the residual.
fn fit_lut(
    settings: &CalibrateSettings,
    curves: &[ExposureCurve],
    warnings: &mut Vec<FitWarning>,
) -> Result<Lut, CalibrateError> {
    let reference_us =
        settings.reference.integration_time_us.unwrap_or(crate::calibration::REFERENCE_TIME_US);
    let mut tables = Vec::new();
    for curve in curves {
        let lut = Lut::fit(&curve.samples, reference_us).map_err(|source| {
            let warnings = curve.warnings.clone();
            CalibrateError::Lut { recording: curve.source.recording.clone(), source, warnings }
        })?;
        warnings.extend(curve.warnings_for(&lut));
        tables.push(lut);
    }
    let mut lut = match tables.as_slice() {
        [single] => single.clone(),
        several => {
            let merged = merge_samples(several);
            Lut::fit(&merged, reference_us).map_err(|source| {
                let warnings = warnings.clone();
                CalibrateError::Lut { recording: "(all together)".into(), source, warnings }
            })?
        }
    };
    lut.fitted_on = curves.iter().map(|curve| curve.source.clone()).collect();
    lut.warnings = warnings.iter().map(ToString::to_string).collect();
    Ok(lut)
}

/// Mean curve of several tables, 1 at the reference, at all their times that every one of them covers. Each is
/// interpolated there, so that sweeps over unlike times do not take turns.
fn merge_samples(tables: &[Lut]) -> Vec<ExposureSample> {
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
        let spread = crate::terms::root_mean_square(logs.iter().map(|log| log - mean)).unwrap_or(0.0);
        Some(ExposureSample { integration_time_us, mean_amplitude_dn: mean.exp(), frame_spread: spread })
    };
    times.into_iter().filter_map(sample).collect()
}

/// Cubic and spline of the same sweeps, the spline of the linear decays where there are any. A spline that cannot be
/// fitted is a warning: the cubic is there.
fn fit_distance(
    settings: &CalibrateSettings,
    sweeps: Vec<ReferenceDecays>,
    linear_sweeps: Vec<ReferenceDecays>,
    calibration: &mut Calibration,
    report: &mut FitReport,
) -> Result<(), CalibrateError> {
    let mut found = Vec::new();
    let (mut sources, mut decays) = (Vec::new(), Vec::new());
    for sweep in sweeps {
        found.extend(sweep.warnings);
        sources.push(sweep.source);
        decays.extend(sweep.decays);
    }
    let reference_m = settings.reference.distance_m;
    let (mut cubic, uses) = Cubic::fit(&decays, reference_m)
        .map_err(|source| CalibrateError::Cubic { source, warnings: found.clone() })?;
    let words = |warnings: &[FitWarning]| warnings.iter().map(ToString::to_string).collect();
    let about_sweeps = found.len();
    found.extend(warning::about_decays(&decays, &uses));
    cubic.warnings = words(&found);
    cubic.fitted_on.clone_from(&sources);
    let mut linear = Vec::new();
    for sweep in linear_sweeps {
        let new = sweep.warnings.into_iter().filter(|warning| !found.contains(warning)).collect::<Vec<_>>();
        found.extend(new);
        linear.extend(sweep.decays);
    }
    let smooth = if linear.is_empty() { &decays } else { &linear };
    match Spline::fit(smooth, reference_m, settings.modulation_frequency_hz) {
        Ok((mut spline, uses)) => {
            let outliers = warning::about_outliers(smooth, &uses);
            spline.warnings = words(&found[..about_sweeps]);
            spline.warnings.extend::<Vec<String>>(words(&outliers));
            spline.fitted_on = sources;
            found.extend(outliers);
            (calibration.terms.spline, report.spline_uses) = (Some(spline), uses);
        }
        Err(reason) => found.push(FitWarning::NoSpline { reason }),
    }
    calibration.terms.cubic = Some(cubic);
    report.warnings.extend(found);
    report.decays = decays.into_iter().zip(uses).collect();
    Ok(())
}
