//! Cameras that no preset is like, calibrated from sweeps as a user would record them. What is measured on them
//! afterwards are other frames than those of the fit.

use isolux::Calibration;
use isolux::calibrate::CalibrateSettings;
use isolux::terms::response::AmbientResponse;
use isolux_camera::scene::run::RegisterRange;
use isolux_camera::{CameraModel, Scene, Simulation};
use isolux_pipeline::calibrate::measure;
use isolux_pipeline::simulate::SimulatedFrames;
use isolux_pipeline::{CalibrationSources, FrameSource, Unobserved, calibrate};

use crate::error::ExperimentError;

/// Seeds of the cameras, which no constant of the library was chosen on.
pub const CAMERAS: [u64; 3] = [101, 102, 103];
/// Seed of the noise of the frames that are fitted on.
const FITTED: u64 = 1;
/// Seed of the noise of the frames that are measured on.
pub(super) const MEASURED: u64 = 2;

/// A camera and its calibration.
#[derive(Clone, Debug)]
pub struct HeldOut {
    /// The camera.
    pub model: CameraModel,
    /// Fitted on a wall over its register and a board over distances.
    pub calibration: Calibration,
    /// The same as a camera gives it that delivers amplitude and distance alone: the spline is not that of linear
    /// amplitudes.
    pub from_amplitude: Calibration,
}

impl HeldOut {
    /// Simulates the sweeps of camera `seed` and fits all that they determine.
    ///
    /// # Errors
    /// [`ExperimentError`], which no seed should bring about.
    pub fn new(seed: u64) -> Result<Self, ExperimentError> {
        let model = CameraModel::random(seed);
        let settings = settings(&model);
        let wall = Simulation::new(model.clone(), wall_scene(&model)?, FITTED)?;
        let board = board(&model)?;
        let sources = CalibrationSources {
            exposure_sweeps: vec![Box::new(SimulatedFrames::new(&wall))],
            distance_sweeps: vec![Box::new(SimulatedFrames::new(&board))],
            ..CalibrationSources::default()
        };
        let measured = measure(&settings, sources, &Unobserved)?;
        let name = Some(model.name.clone());
        let (from_amplitude, _) = measured.of_delivered_amplitudes().fit(name.clone(), &Unobserved)?;
        let (calibration, _) = measured.fit(name, &Unobserved)?;
        Ok(Self { model, calibration, from_amplitude })
    }
}

/// The response of camera `seed` by amplitude and distance, which the board alone determines.
///
/// # Errors
/// [`ExperimentError`], which no seed should bring about.
pub(super) fn ambient(seed: u64) -> Result<Option<AmbientResponse>, ExperimentError> {
    let model = CameraModel::random(seed);
    let board = board(&model)?;
    let distance_sweeps: Vec<Box<dyn FrameSource + '_>> = vec![Box::new(SimulatedFrames::new(&board))];
    let sources = CalibrationSources { distance_sweeps, ..CalibrationSources::default() };
    let (calibration, _) = calibrate(&settings(&model), None, sources, &Unobserved)?;
    Ok(calibration.terms.response.and_then(|response| response.ambient))
}

fn settings(model: &CameraModel) -> CalibrateSettings {
    CalibrateSettings {
        modulation_frequency_hz: Some(model.modulation_frequency_hz),
        ..CalibrateSettings::default()
    }
}

fn board(model: &CameraModel) -> Result<Simulation, ExperimentError> {
    Ok(Simulation::new(cropped(model), Scene::builtin("board-distances")?, FITTED)?)
}

/// The wall at about fifty times of the camera's register.
fn wall_scene(model: &CameraModel) -> Result<Scene, ExperimentError> {
    let mut scene = Scene::builtin("wall-sweep")?;
    let last = model.integration_register.maximum;
    for run in &mut scene.runs {
        run.registers = Some(RegisterRange { first: 0, last, step: (last / 50).max(1) });
    }
    Ok(scene)
}

/// The camera's image around the principal point alone: all that a board in the centre needs.
pub(super) fn cropped(model: &CameraModel) -> CameraModel {
    const SIDE: usize = 40;
    let mut model = CameraModel { height: SIDE, width: SIDE, ..model.clone() };
    let centre = (SIDE - 1) as f64 / 2.0;
    (model.intrinsics.cx, model.intrinsics.cy) = (centre, centre);
    model
}
