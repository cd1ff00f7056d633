//! From recordings to a [`Calibration`]: measure sweeps frame by frame, then fit the terms they determine.

mod distance_sweep;
mod evidence;
mod exposure_sweep;
mod factors;
pub mod joint;
mod noise_survey;
mod response;
mod runs;
pub mod scene;
mod target;
mod warning;
mod window;

pub use distance_sweep::{DistanceSweep, ReferenceDecays};
pub use evidence::ResponseEvidence;
pub use exposure_sweep::{ExposureCurve, ExposureSweep};
pub use noise_survey::{NoiseCells, NoiseSurvey};
pub use scene::{CameraMotion, MotionFinding, MotionScout, SceneObservations, SceneReport, SceneSweep};
pub use target::{SurfaceUse, TargetReport, TargetSweep, TargetWindows, label_windows};
pub use warning::FitWarning;

use crate::calibration::{Calibration, NoiseFloor, Reference};
use crate::frame::IntegrationTime;
use crate::plane::ShapeError;
use crate::standardize::StandardizeError;
use crate::terms::cubic::{CubicError, Decay, DecayUse, Scaling};
use crate::terms::lut::{ExposureSample, LutAnswer, LutError};
use crate::terms::spline::SplineUse;
use crate::terms::{Cubic, Lut, Response, Spline};

/// What the user decides about a calibration.
#[derive(Clone, Debug, PartialEq)]
pub struct CalibrateSettings {
    /// Conditions under which every multiplier is 1.
    pub reference: Reference,
    /// Side of the central measurement window of a distance sweep, pixels; 20 in the paper.
    pub window_px: usize,
    /// Frames dropped after each change of the integration time; 50 in the paper.
    pub skip_frames: usize,
    /// Integration times to leave out, µs.
    pub exclude_time_us: Vec<f64>,
    /// Modulation frequency of the sweeps, Hz, where it is known: the spline then allows for the aliased harmonic, and
    /// the response of the raw bins repairs the distance.
    pub modulation_frequency_hz: Option<f64>,
}

impl Default for CalibrateSettings {
    fn default() -> Self {
        Self {
            reference: Reference::default(),
            window_px: 20,
            skip_frames: 0,
            exclude_time_us: Vec::new(),
            modulation_frequency_hz: None,
        }
    }
}

impl CalibrateSettings {
    /// A time is excluded when it equals one of the list to 0.01 %, more than f32 rounding and less than any
    /// camera's step.
    fn excludes(&self, integration_time_us: f64) -> bool {
        let same = |excluded: &f64| (integration_time_us / excluded - 1.0).abs() < 1e-4;
        self.exclude_time_us.iter().any(same)
    }
}

/// Why a recording cannot serve as a sweep, or a term cannot be fitted.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CalibrateError {
    /// Frames without a single integration time in an exposure sweep.
    #[error(
        "frame {frame}: integration time is {found}, one known time for the whole frame expected: \
             an exposure sweep varies the time from frame to frame"
    )]
    NoSingleTime {
        /// Frame number, from 0.
        frame: usize,
        /// What is there.
        found: &'static str,
    },
    /// A distance sweep without distances.
    #[error(
        "frame {frame}: no distance channel found, one expected: a distance sweep is measured against it"
    )]
    NoDistance {
        /// Frame number, from 0.
        frame: usize,
    },
    /// A frame without a pose where poses are said to be recorded.
    #[error("frame {frame}: no pose (`world_from_camera`) found, one for every frame expected")]
    NoPose {
        /// Frame number, from 0.
        frame: usize,
    },
    /// A pose that is not rigid.
    #[error(
        "frame {frame}: `world_from_camera` is no rigid transform: a rotation (orthonormal, no mirror), a translation \
         in metres and a last row of 0 0 0 1 expected"
    )]
    NotRigid {
        /// Frame number, from 0.
        frame: usize,
    },
    /// A frame whose planes do not fit together.
    #[error("frame {frame}: {source}")]
    Shape {
        /// Frame number, from 0.
        frame: usize,
        /// The plane.
        source: ShapeError,
    },
    /// A target's recording without labels.
    #[error(
        "frame {frame}: no target channel found, one expected: its labels say which pixels are one material"
    )]
    NoTarget {
        /// Frame number, from 0.
        frame: usize,
    },
    /// Targets' recordings of unlike formats.
    #[error(
        "target {recording}: images of {found} found, {expected} expected: a profile holds for one format"
    )]
    TargetShape {
        /// The recording.
        recording: String,
        /// Its shape.
        found: String,
        /// That of the first.
        expected: String,
    },
    /// A camera that moves, without intrinsics.
    #[error(
        "no intrinsics {{fx, fy, cx, cy}} in recording.json, expected: a camera that moves sees its surfaces through them"
    )]
    NoIntrinsics,
    /// Scenes of unlike formats.
    #[error("scene {recording}: images of {found} found, {expected} expected: one camera, one format")]
    SceneShape {
        /// The recording.
        recording: String,
        /// Its shape.
        found: String,
        /// That of the first.
        expected: String,
    },
    /// The joint model could not be fitted.
    #[error("targets: {0}")]
    Target(joint::JointError),
    /// A frame that the response cannot make linear.
    #[error("linear amplitude: {0}")]
    Linear(#[from] StandardizeError),
    /// No sweep given.
    #[error(
        "no recording given: calibrate needs at least one exposure sweep, distance sweep, target or scene"
    )]
    NothingToFit,
    /// The table could not be fitted.
    #[error("exposure sweep {recording}: {source}")]
    Lut {
        /// The recording.
        recording: String,
        /// Why.
        source: LutError,
        /// What was left out before, and why.
        warnings: Vec<FitWarning>,
    },
    /// The cubic could not be fitted.
    #[error("distance sweep: {source}")]
    Cubic {
        /// Why.
        source: CubicError,
        /// What was left out before, and why.
        warnings: Vec<FitWarning>,
    },
}

impl CalibrateError {
    /// What was left out before the fit failed: often the reason.
    #[must_use]
    pub fn warnings(&self) -> &[FitWarning] {
        match self {
            Self::Lut { warnings, .. } | Self::Cubic { warnings, .. } => warnings,
            _ => &[],
        }
    }
}

/// What the fits found, for the user to judge them.
#[derive(Clone, Debug, PartialEq)]
pub struct FitReport {
    /// Exposure samples of each exposure sweep.
    pub exposure_curves: Vec<ExposureCurve>,
    /// Reference decays as they entered the cubic, with what became of them.
    pub decays: Vec<(Decay, DecayUse)>,
    /// What became of the same decays in the spline; empty where there is none.
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
    let linear: Vec<Decay> = linear_sweeps.into_iter().flat_map(|sweep| sweep.decays).collect();
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

/// The one time of a frame; an error message's words where there is none.
fn single_time(time: &IntegrationTime) -> Result<f64, &'static str> {
    match time {
        IntegrationTime::PerFrame(time) => Ok(*time),
        IntegrationTime::Unknown => Err("unknown"),
        IntegrationTime::PerPixel(_) => Err("a map with a time for each pixel"),
    }
}

impl Scaling {
    /// In words, for reports.
    #[must_use]
    pub fn describe(self) -> &'static str {
        match self {
            Self::AtReference => "normalized at the reference distance",
            Self::OntoOthers => "scaled onto the others",
            Self::LeftOut => "left out",
        }
    }
}

/// The noise floor that a measured deviation stands for; none where quantization hides it.
fn noise_floor(deviation_dn: Option<f64>, integration_time_us: f64) -> Option<NoiseFloor> {
    deviation_dn.filter(|sd| *sd > 0.0 && sd.is_finite()).map(|sd| NoiseFloor::new(sd, integration_time_us))
}
