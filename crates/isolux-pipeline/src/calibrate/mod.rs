//! Fits a calibration to recordings of sweeps, targets and scenes.
//!
//! There are two stages. First, exposure sweeps are measured, and the terms of the integration time are fitted to
//! them. Then distance sweeps, targets and scenes are measured, with linear frames where the fitted response and
//! their channels allow it, and all other terms are fitted.

mod linear;
mod measure;

use std::path::{Path, PathBuf};

use isolux::Calibration;
use isolux::calibrate::{CalibrateError, CalibrateSettings, ExposureFit, FitReport, Measurements, Verdict};

use self::measure::Measurer;
use crate::error::PipelineError;
use crate::observer::Observer;
use crate::remark::Remark;
use crate::source::{FrameSource, open_all};

/// Recordings of one kind.
type Frames<'a> = Vec<Box<dyn FrameSource + 'a>>;

/// Frames to calibrate from, by what they show.
#[derive(Default)]
pub struct CalibrationSources<'a> {
    /// Still scenes while the integration time is varied.
    pub exposure_sweeps: Frames<'a>,
    /// Flat targets at several distances.
    pub distance_sweeps: Frames<'a>,
    /// Labelled materials in any pose.
    pub targets: Frames<'a>,
    /// Ordinary recordings without a rig.
    pub scenes: Frames<'a>,
}

/// Paths of recordings to calibrate from, by what they show.
#[derive(Clone, Copy, Debug, Default)]
pub struct CalibrationPaths<'a> {
    /// Still scenes while the integration time is varied.
    pub exposure_sweeps: &'a [PathBuf],
    /// Flat targets at several distances.
    pub distance_sweeps: &'a [PathBuf],
    /// Labelled materials in any pose.
    pub targets: &'a [PathBuf],
    /// Ordinary recordings without a rig.
    pub scenes: &'a [PathBuf],
}

impl<'a> CalibrationPaths<'a> {
    /// All of them.
    pub fn all(self) -> impl Iterator<Item = &'a Path> {
        let sweeps = self.exposure_sweeps.iter().chain(self.distance_sweeps);
        sweeps.chain(self.targets).chain(self.scenes).map(PathBuf::as_path)
    }

    /// Opens them.
    ///
    /// # Errors
    /// [`PipelineError::Recording`] for a path that holds no recording.
    pub fn open(self) -> Result<CalibrationSources<'static>, PipelineError> {
        Ok(CalibrationSources {
            exposure_sweeps: open_all(self.exposure_sweeps)?,
            distance_sweeps: open_all(self.distance_sweeps)?,
            targets: open_all(self.targets)?,
            scenes: open_all(self.scenes)?,
        })
    }
}

/// Measures the recordings and fits the terms that they determine. The camera's name is `camera`, or else the one
/// in the recordings. What could not be determined, and why, is in the report, or in the error's
/// [`warnings`](PipelineError::warnings).
///
/// # Errors
/// Those of [`measure`] and [`Measured::fit`].
pub fn calibrate(
    settings: &CalibrateSettings,
    camera: Option<String>,
    sources: CalibrationSources<'_>,
    observer: &dyn Observer,
) -> Result<(Calibration, FitReport), PipelineError> {
    measure(settings, sources, observer)?.fit(camera, observer)
}

/// Measured recordings, before the second stage of fits.
#[derive(Clone, Debug)]
pub struct Measured {
    exposure: ExposureFit,
    measurements: Measurements,
    /// Names of the cameras, each run of equal ones once.
    cameras: Vec<String>,
    /// Names of the distance sweeps.
    distance_sweeps: Vec<String>,
    /// Whether a poor calibration is given all the same.
    accept_poor_fit: bool,
}

/// Measures recordings in the order of the two stages. The modulation frequency is that of the settings, or else of
/// the distance sweeps, of the targets if there are none, or of the scenes if there are neither.
///
/// # Errors
/// [`PipelineError::Measure`] for recordings that cannot be measured; [`PipelineError::Fit`] when no table can be
/// fitted to an exposure sweep; those of reading; [`PipelineError::Interrupted`] once the observer has cancelled.
pub fn measure(
    settings: &CalibrateSettings,
    sources: CalibrationSources<'_>,
    observer: &dyn Observer,
) -> Result<Measured, PipelineError> {
    let CalibrationSources { exposure_sweeps, distance_sweeps, targets, scenes } = sources;
    let mut settings = settings.clone();
    if settings.modulation_frequency_hz.is_none() {
        let kinds = [&distance_sweeps, &targets, &scenes, &exposure_sweeps];
        let told_by = kinds.into_iter().find(|sources| !sources.is_empty());
        settings.modulation_frequency_hz =
            told_by.and_then(|told_by| modulation_frequency_hz(told_by, observer));
    }
    let names = |sources: &Frames<'_>| sources.iter().map(|source| source.facts().name).collect();
    let distance_sweep_names: Vec<String> = names(&distance_sweeps);
    let mut measurer = Measurer { settings: &settings, observer, cameras: Vec::new() };
    let curves = exposure_sweeps.into_iter().map(|mut source| measurer.exposure_curve(&mut *source));
    let curves = curves.collect::<Result<Vec<_>, _>>()?;
    let exposure = ExposureFit::new(&settings, curves).map_err(fit_error(&distance_sweep_names))?;
    let mut measurements = Measurements::default();
    for mut source in distance_sweeps {
        let (delivered, linear) = measurer.reference_decays(&mut *source, exposure.response())?;
        measurements.add_distance_sweep(delivered, linear);
    }
    for mut source in targets {
        measurements.add_target(measurer.target_windows(&mut *source, exposure.response())?);
    }
    for mut source in scenes {
        measurements.add_scene(measurer.scene_observations(&mut *source, exposure.response())?);
    }
    let mut cameras = measurer.cameras;
    cameras.dedup();
    Ok(Measured {
        exposure,
        measurements,
        cameras,
        distance_sweeps: distance_sweep_names,
        accept_poor_fit: settings.accept_poor_fit,
    })
}

impl Measured {
    /// Fits every term that the recordings determine. The camera's name is `camera`, or else the one in the
    /// recordings.
    ///
    /// # Errors
    /// [`PipelineError::Fit`] when no recording was given or a term cannot be fitted; [`PipelineError::PoorFit`] when
    /// the verdict on the terms is poor, unless the settings accept that.
    pub fn fit(
        self,
        camera: Option<String>,
        observer: &dyn Observer,
    ) -> Result<(Calibration, FitReport), PipelineError> {
        if camera.is_none() && self.cameras.len() > 1 {
            observer.remark(Remark::CamerasDiffer { cameras: self.cameras.clone() });
        }
        let camera = camera.or_else(|| self.cameras.into_iter().next());
        let fitted = self.exposure.complete(camera, self.measurements);
        let (calibration, report) = fitted.map_err(fit_error(&self.distance_sweeps))?;
        match Verdict::of(&calibration, &report) {
            verdict @ Verdict::Poor { .. } if !self.accept_poor_fit => {
                Err(PipelineError::PoorFit { verdict, warnings: report.warnings })
            }
            _ => Ok((calibration, report)),
        }
    }

    /// The same without the linear measurements of distance sweeps, as for a camera that delivers only amplitude
    /// and distance.
    #[must_use]
    pub fn of_delivered_amplitudes(&self) -> Self {
        let measurements = self.measurements.clone().of_delivered_amplitudes();
        Self { measurements, ..self.clone() }
    }

    /// What was measured of distance sweeps, targets and scenes.
    #[must_use]
    pub fn measurements(&self) -> &Measurements {
        &self.measurements
    }
}

fn fit_error(distance_sweeps: &[String]) -> impl Fn(CalibrateError) -> PipelineError {
    |cause| PipelineError::Fit { distance_sweeps: distance_sweeps.to_vec(), cause }
}

/// The modulation frequency of all these recordings; `None` where they differ or one does not state it.
fn modulation_frequency_hz(sources: &Frames<'_>, observer: &dyn Observer) -> Option<f64> {
    let named = sources.iter().map(|source| source.facts().traits().modulation_frequency_hz);
    let mut frequencies: Vec<Option<f64>> = named.collect();
    frequencies.dedup();
    if frequencies.len() > 1 {
        observer.remark(Remark::FrequenciesDiffer);
        return None;
    }
    frequencies.first().copied().flatten()
}
