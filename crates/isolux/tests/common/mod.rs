//! What the proofs share: simulated sweeps, the calibration fitted on them, standardized frames, and naive versions of
//! the fits and of the chain.
#![allow(dead_code, unreachable_pub, reason = "each test binary uses its own part")]

pub mod naive_chain;
pub mod naive_fit;
pub mod noise_theory;
pub mod standardize;
pub mod strategies;

use isolux::calibrate::{CalibrateSettings, DistanceSweep, ExposureSweep, fit};
use isolux::{Calibration, Frame};
use isolux_camera::{CameraModel, Scene, SimulatedFrame, Simulation};

/// A built-in scene before the camera that it is made for.
pub fn builtin(scene: &str, seed: u64) -> Simulation {
    let scene = Scene::builtin(scene).unwrap();
    let model = CameraModel::preset(&scene.camera).unwrap();
    Simulation::new(model, scene, seed).unwrap()
}

/// A preset with an image of `height`×`width` pixels around the principal point: small and fast.
pub fn cropped(preset: &str, height: usize, width: usize) -> CameraModel {
    let mut model = CameraModel::preset(preset).unwrap();
    (model.height, model.width) = (height, width);
    (model.intrinsics.cy, model.intrinsics.cx) = ((height - 1) as f64 / 2.0, (width - 1) as f64 / 2.0);
    model
}

/// Every frame of a recording.
pub fn render(simulation: &Simulation) -> Vec<SimulatedFrame> {
    let mut frames = Vec::new();
    simulation.render_frames(0..simulation.len(), &mut frames).unwrap();
    frames
}

/// Fits what the two sweeps determine; either may be empty.
pub fn calibrate(
    settings: &CalibrateSettings,
    exposure_sweep: &[SimulatedFrame],
    distance_sweep: &[SimulatedFrame],
) -> Calibration {
    let mut wall = ExposureSweep::new("wall", settings);
    exposure_sweep.iter().for_each(|simulated| wall.push(&simulated.frame).unwrap());
    let mut board = DistanceSweep::new("board", settings);
    distance_sweep.iter().for_each(|simulated| board.push(&simulated.frame).unwrap());
    let curves = if exposure_sweep.is_empty() { vec![] } else { vec![wall.finish()] };
    let decays = if distance_sweep.is_empty() { vec![] } else { vec![board.finish()] };
    fit(settings, None, curves, decays).unwrap().0
}

/// The integration time of a simulated frame, µs.
pub fn time_us(frame: &Frame) -> f64 {
    match frame.integration_time_us {
        isolux::IntegrationTime::PerFrame(time_us) => time_us,
        _ => panic!("no single integration time"),
    }
}
