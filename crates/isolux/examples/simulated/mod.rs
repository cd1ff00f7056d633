//! What the examples share: recordings of a simulated camera, in place of your own.
#![allow(dead_code, unreachable_pub, reason = "each example uses its own part")]

use std::error::Error;

use isolux::calibrate::{CalibrateSettings, DistanceSweep, ExposureSweep, fit};
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

/// A calibration of that camera. Example 02 shows step by step how it is made.
pub fn calibration() -> Result<Calibration, Box<dyn Error>> {
    let settings = CalibrateSettings::default();
    let mut wall = ExposureSweep::new("wall", &settings);
    for frame in record("wall-sweep-smoke")? {
        wall.push(&frame)?;
    }
    let mut board = DistanceSweep::new("board", &settings);
    for frame in record("board-distances-smoke")? {
        board.push(&frame)?;
    }
    let (calibration, _) = fit(&settings, None, vec![wall.finish()], vec![board.finish()])?;
    Ok(calibration)
}
