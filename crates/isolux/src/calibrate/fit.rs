//! From measurements to terms, in two stages: what the integration time does, then everything that is fitted to linear
//! amplitudes.

use super::distance::{self, DistanceFit, ReferenceDecays};
use super::exposure::{self, ExposureCurve, TableError};
use super::measurements::DistanceSweeps;
use super::{CalibrateError, CalibrateSettings, FitReport, FitWarning, Measurements, scene, target};
use crate::calibration::Calibration;
use crate::terms::Response;

/// The first stage of a calibration: what exposure sweeps determine. Whatever is fitted after it needs the response, to
/// make its frames linear.
///
/// 1. Measure the exposure sweeps, [`ExposureSweep`](super::ExposureSweep), and fit them: [`ExposureFit::new`].
/// 2. With [`ExposureFit::response`], make the frames of all other recordings linear, where their channels allow it
///    ([`FrameLineariser`](crate::standardize::FrameLineariser)): amplitudes that grow in proportion to the light. Measure
///    distance sweeps of frames as they were delivered *and* of linear ones; targets and scenes of linear ones, or of
///    those delivered where there are none. Collect them in [`Measurements`].
/// 3. Fit the other terms: [`ExposureFit::complete`].
#[derive(Clone, Debug)]
pub struct ExposureFit {
    settings: CalibrateSettings,
    calibration: Calibration,
    curves: Vec<ExposureCurve>,
    warnings: Vec<FitWarning>,
}

/// Fits every term that exposure sweeps and distance sweeps of frames as they were delivered determine: both stages at
/// once.
///
/// # Errors
/// [`CalibrateError`] when no sweep is given or a term cannot be fitted from what is there.
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
    /// Fits every term that exposure sweeps determine; without one, none.
    ///
    /// # Errors
    /// [`CalibrateError::Lut`] when a sweep has no table.
    pub fn new(settings: &CalibrateSettings, curves: Vec<ExposureCurve>) -> Result<Self, CalibrateError> {
        let mut calibration = Calibration::new(None, settings.reference);
        let warnings = if curves.is_empty() {
            // Nothing says what the amplitudes of another time would be.
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

    /// The response that was fitted.
    #[must_use]
    pub fn response(&self) -> Option<&Response> {
        self.calibration.terms.response.as_ref()
    }

    /// Fits every other term that the recordings determine, for the camera of this name.
    ///
    /// # Errors
    /// [`CalibrateError`] when no recording is given or a term cannot be fitted from what is there.
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
