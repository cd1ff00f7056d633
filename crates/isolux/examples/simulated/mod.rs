//! What the examples share: recordings of a simulated camera, in place of your own.
#![allow(dead_code, unreachable_pub, reason = "each example uses its own part")]

use std::error::Error;

use isolux::calibrate::{CalibrateSettings, ExposureSweep, fit};
use isolux::{Calibration, Frame};
use isolux_camera::{CameraModel, Scene, Simulation};

/// Every frame that a simulated SR-3100 delivers of a built-in scene.
pub fn record(scene: &str) -> Result<Vec<Frame>, Box<dyn Error>> {
    let scene = Scene::builtin(scene)?;
    let simulation = Simulation::new(CameraModel::preset(&scene.camera)?, scene, 1)?;
    let mut frames = Vec::new();
    simulation.render_frames(0..simulation.len(), &mut frames)?;
    Ok(frames.into_iter().map(|simulated| simulated.frame).collect())
}

/// A calibration of that camera over the integration time. Example 02 shows how a complete one is made.
pub fn calibration() -> Result<Calibration, Box<dyn Error>> {
    let settings = CalibrateSettings::default();
    let mut sweep = ExposureSweep::new("wall", &settings);
    for frame in record("wall-sweep-smoke")? {
        sweep.push(&frame)?;
    }
    let (calibration, _) = fit(&settings, None, vec![sweep.finish()], vec![])?;
    Ok(calibration)
}
