//! Self-calibration without a rig: how near do the terms that a recording of unknown things gives come to the truth of
//! the camera, and what do recordings refuse to tell?

mod runs;
mod spoil;

use std::time::{Duration, Instant};

use isolux::calibrate::joint::{Factor, Finding};
use isolux::calibrate::scene::SceneReport;
use isolux::calibrate::{CalibrateSettings, FitReport, MotionFinding};
use isolux::terms::lut::LutAnswer;
use isolux::{Calibration, Frame, Reference};
use isolux_camera::{CameraModel, Scene, Simulation};
use isolux_pipeline::simulate::SimulatedFrames;
use isolux_pipeline::{CalibrationSources, FrameSource, FramesInMemory, SourceFacts, Unobserved, calibrate};

pub use runs::RunKind;
pub use spoil::Spoil;

use crate::error::ExperimentError;
use crate::measure::for_each;

/// The recording, as messages name it.
const RUN: &str = "run";

/// Where the poses come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Poses {
    /// The true ones, recorded.
    Recorded,
    /// Left out of the recording.
    Missing,
}

/// One experiment.
#[derive(Clone, Debug)]
pub struct Experiment {
    /// The camera; its physics are unknown to the calibration, its pinhole and modulation frequency are known.
    pub camera: CameraModel,
    /// What is recorded.
    pub scene: Scene,
    /// With or without poses.
    pub poses: Poses,
    /// Noise and outliers instead of the camera's own.
    pub spoil: Option<Spoil>,
    /// Seed of all noise.
    pub seed: u64,
}

/// Deviation of a fitted curve from the truth, relative: 0.01 is 1 %.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Deviation {
    /// Largest, in the support of the curve.
    pub largest: f64,
    /// Root mean square.
    pub typical: f64,
}

/// What an experiment shows.
#[derive(Clone, Debug)]
pub struct SelfCalibration {
    /// Of S(t), at the recorded times; `None` where it is refused.
    pub time: Option<Deviation>,
    /// Of h(d), at 41 distances of its range.
    pub distance: Option<Deviation>,
    /// Of v, in the pixels of its support.
    pub profile: Option<Deviation>,
    /// k, where it is told; the truth is 1.
    pub angle_exponent: Option<f64>,
    /// How the camera was found to have moved.
    pub motion: MotionFinding,
    /// The report of the fit.
    pub report: SceneReport,
    /// What was refused, and why, in words.
    pub warnings: Vec<String>,
    /// Frames of the recording.
    pub frames: usize,
    /// Measuring and fitting, without simulating. It depends on the machine and on what else it does.
    pub elapsed: Duration,
}

impl SelfCalibration {
    /// True when the observations determine the factor.
    #[must_use]
    pub fn determines(&self, factor: Factor) -> bool {
        let finding = |finding: &&Finding| finding.factor == factor;
        self.report.findings.iter().find(finding).is_some_and(|finding| finding.refusal.is_none())
    }
}

/// Records, calibrates from the recording alone, and compares with the camera's own laws.
///
/// # Errors
/// [`ExperimentError`] when the simulation fails or the recording is no scene.
pub fn measure(experiment: &Experiment) -> Result<SelfCalibration, ExperimentError> {
    let camera = &experiment.camera;
    let simulation = Simulation::new(camera.clone(), experiment.scene.clone(), experiment.seed)?;
    let mut frames = Vec::new();
    for_each(&simulation, |index, simulated| {
        let mut frame = simulated.frame.clone();
        if let Some(spoil) = experiment.spoil {
            spoil.apply(&simulated.truth, camera, experiment.seed ^ ((index as u64) << 32), &mut frame);
        }
        if experiment.poses == Poses::Missing {
            frame.world_from_camera = None;
        }
        frames.push(frame);
        Ok(())
    })?;
    let settings = CalibrateSettings {
        reference: Reference::default(),
        modulation_frequency_hz: Some(camera.modulation_frequency_hz),
        // The experiment compares with the truth what a recording gives, however spoilt.
        accept_poor_fit: true,
        ..CalibrateSettings::default()
    };
    let start = Instant::now();
    let (calibration, fit) = calibrate_from(&settings, &simulation, &frames)?;
    let elapsed = start.elapsed();
    let missing = |missing| ExperimentError::Scene { scene: RUN, missing };
    let report = fit.scene.ok_or(missing("a report"))?;
    let motion = report.scenes.first().ok_or(missing("its motion"))?.motion;
    Ok(SelfCalibration {
        elapsed,
        time: time(&calibration),
        distance: distance(&calibration, camera),
        profile: profile(&calibration, camera),
        angle_exponent: calibration.terms.angle.map(|angle| angle.exponent),
        motion,
        report,
        warnings: fit.warnings.iter().map(ToString::to_string).collect(),
        frames: frames.len(),
    })
}

fn calibrate_from(
    settings: &CalibrateSettings,
    simulation: &Simulation,
    frames: &[Frame],
) -> Result<(Calibration, FitReport), ExperimentError> {
    let facts = SourceFacts { name: RUN.to_owned(), ..SimulatedFrames::new(simulation).facts() };
    let run = FramesInMemory::new(facts, frames);
    let sources = CalibrationSources { scenes: vec![Box::new(run)], ..CalibrationSources::default() };
    Ok(calibrate(settings, None, sources, &Unobserved)?)
}

/// Nothing saturates in these runs, so the amplitude is proportional to the time.
fn time(calibration: &Calibration) -> Option<Deviation> {
    let lut = calibration.terms.lut.as_ref()?;
    let reference_us = calibration.reference.integration_time_us?;
    let relative = lut.integration_time_us.iter().filter_map(|&time_us| match lut.at(time_us) {
        LutAnswer::Inside(multiplier) => Some(multiplier * time_us / reference_us - 1.0),
        LutAnswer::Below(_) | LutAnswer::Refused => None,
    });
    deviation(relative)
}

fn distance(calibration: &Calibration, camera: &CameraModel) -> Option<Deviation> {
    const STEPS: u32 = 40;
    let spline = calibration.terms.spline.as_ref()?;
    let [min_m, max_m] = spline.law.valid_distance_m;
    deviation((0..=STEPS).map(|step| {
        let distance_m = min_m * (max_m / min_m).powf(f64::from(step) / f64::from(STEPS));
        let truth = camera.distance_response(distance_m, spline.law.reference_distance_m);
        spline.ln_response(distance_m).exp() / truth - 1.0
    }))
}

fn profile(calibration: &Calibration, camera: &CameraModel) -> Option<Deviation> {
    let profile = calibration.terms.profile.as_ref()?;
    let (places, shape) = (profile.places(), profile.shape());
    let pixels = (0..shape.pixels()).map(|index| (index / shape.width, index % shape.width));
    deviation(pixels.filter_map(|(row, column)| {
        let (row, column) = (row as f64, column as f64);
        let place = places.at(row, column);
        let truth = camera.illumination_profile_at(row, column);
        profile.supports(place).then(|| profile.ln_gain(place).exp() / truth - 1.0)
    }))
}

fn deviation(relative: impl Iterator<Item = f64>) -> Option<Deviation> {
    let (mut largest, mut squares, mut count) = (0.0f64, 0.0, 0.0);
    for error in relative {
        (largest, squares, count) = (largest.max(error.abs()), squares + error * error, count + 1.0);
    }
    (count > 0.0).then(|| Deviation { largest, typical: (squares / count).sqrt() })
}
