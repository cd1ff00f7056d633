//! Fits terms to measurements in two stages: first those of the integration time, then all others.

use super::distance::{self, DistanceFit, ReferenceDecays};
use super::exposure::{self, ExposureCurve, TableError};
use super::measurements::DistanceSweeps;
use super::{CalibrateError, CalibrateSettings, FitReport, FitWarning, Measurements, scene, target, verdict};
use crate::calibration::Calibration;
use crate::terms::{Lut, Response};

/// The first stage of a calibration: the terms that exposure sweeps determine. The second stage needs the fitted
/// response to make its frames linear.
///
/// 1. Measure the exposure sweeps, [`ExposureSweep`](super::ExposureSweep), and fit them: [`ExposureFit::new`].
/// 2. With [`ExposureFit::response`], make the frames of all other recordings linear, where their channels allow it
///    ([`FrameLineariser`](crate::standardize::FrameLineariser)): their amplitudes are then in proportion to the
///    light. Measure each distance sweep twice, with frames as delivered *and* with linear frames. Measure targets
///    and scenes once, with linear frames where possible. Collect the results in [`Measurements`].
/// 3. Fit the other terms: [`ExposureFit::complete`].
#[derive(Clone, Debug)]
pub struct ExposureFit {
    settings: CalibrateSettings,
    calibration: Calibration,
    curves: Vec<ExposureCurve>,
    warnings: Vec<FitWarning>,
}

/// Fits every term that exposure sweeps and distance sweeps determine, both stages at once, without linear frames.
///
/// # Errors
/// [`CalibrateError`] when no sweep is given or a term cannot be fitted.
pub fn fit(
    settings: &CalibrateSettings,
    camera: Option<String>,
    exposure_curves: Vec<ExposureCurve>,
    distance_sweeps: Vec<ReferenceDecays>,
) -> Result<(Calibration, FitReport), CalibrateError> {
    let mut measured = Measurements::default();
    distance_sweeps.into_iter().for_each(|sweep| measured.add_distance_sweep(sweep, None));
    ExposureFit::new(settings, exposure_curves)?.complete(camera, measured)
}

impl ExposureFit {
    /// Fits every term that exposure sweeps determine. Without sweeps, there is no term.
    ///
    /// # Errors
    /// [`CalibrateError::Lut`] when no table can be fitted to a sweep.
    pub fn new(settings: &CalibrateSettings, curves: Vec<ExposureCurve>) -> Result<Self, CalibrateError> {
        let settings =
            &settings.with_reference_time(curves.iter().filter_map(|c| Lut::covered_us(&c.samples)));
        let mut calibration = Calibration::new(None, settings.reference);
        let warnings = if curves.is_empty() {
            // Without a table, amplitudes cannot be brought to another time.
            calibration.reference.integration_time_us = None;
            Vec::new()
        } else {
            exposure::fit(settings, &curves, &mut calibration)
                .map_err(|TableError { recording, source, warnings }| {
                    let warnings = warnings.into_iter().map(FitWarning::Exposure).collect();
                    CalibrateError::Lut { recording, source, warnings }
                })?
                .into_iter()
                .map(FitWarning::Exposure)
                .collect()
        };
        Ok(Self { settings: settings.clone(), calibration, curves, warnings })
    }

    /// The fitted response, if there is one.
    #[must_use]
    pub fn response(&self) -> Option<&Response> {
        self.calibration.terms.response.as_ref()
    }

    /// Fits every other term that the recordings determine. `camera` is the name of the camera.
    ///
    /// # Errors
    /// [`CalibrateError`] when no recording is given or a term cannot be fitted.
    pub fn complete(
        self,
        camera: Option<String>,
        measured: Measurements,
    ) -> Result<(Calibration, FitReport), CalibrateError> {
        let Self { settings, mut calibration, curves, warnings } = self;
        calibration.camera = camera;
        if curves.is_empty() && measured.is_empty() {
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
        let (distances, targets, scenes) = measured.into_parts();
        if !distances.delivered.is_empty() {
            fit_distances(&settings, distances, &mut calibration, &mut report)?;
        }
        if !targets.is_empty() {
            let (found, warnings) = target::fit(&settings, &targets, &mut calibration)?;
            report.target = Some(found);
            report.warnings.extend(warnings.into_iter().map(FitWarning::Target));
        }
        if !scenes.is_empty() {
            let (found, warnings) =
                scene::fit(&settings, &scenes, &mut calibration).map_err(CalibrateError::SceneShapes)?;
            report.scene = Some(found);
            report.warnings.extend(warnings.into_iter().map(FitWarning::Scene));
        }
        report.warnings.extend(verdict::misfits(&calibration, &report));
        Ok((calibration, report))
    }
}

fn fit_distances(
    settings: &CalibrateSettings,
    DistanceSweeps { delivered, linear }: DistanceSweeps,
    calibration: &mut Calibration,
    report: &mut FitReport,
) -> Result<(), CalibrateError> {
    let fitted = distance::fit(settings, delivered, linear, calibration);
    let DistanceFit { decays, spline_uses, warnings } = fitted.map_err(|(source, warnings)| {
        let warnings = warnings.into_iter().map(FitWarning::Distance).collect();
        CalibrateError::Cubic { source, warnings }
    })?;
    (report.decays, report.spline_uses) = (decays, spline_uses);
    report.warnings.extend(warnings.into_iter().map(FitWarning::Distance));
    Ok(())
}
