//! Exposures of unseen cameras in the dark and in strong ambient light.

use isolux::PixelFlags;
use isolux::phase::CLIPPED_SHARE;
use isolux_camera::{CameraModel, FullWell, Scene, SimulatedFrame, Simulation};

use crate::error::ExperimentError;

/// The light besides the camera's own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Light {
    /// None.
    Dark,
    /// Several times the camera's own on everything beyond 1 m.
    StrongAmbient,
}

/// A random camera with fewer pixels of the same view.
pub(super) fn camera_of(seed: u64) -> CameraModel {
    let mut model = CameraModel::random(seed);
    let [down, across] = [48.0 / model.height as f64, 64.0 / model.width as f64];
    (model.height, model.width) = (48, 64);
    let intrinsics = &mut model.intrinsics;
    (intrinsics.fx, intrinsics.cx) = (intrinsics.fx * across, intrinsics.cx * across);
    (intrinsics.fy, intrinsics.cy) = (intrinsics.fy * down, intrinsics.cy * down);
    model
}

/// Ambient light relative to the active light on the axis at 1 m.
fn ambient(light: Light) -> f64 {
    match light {
        Light::Dark => 0.0,
        Light::StrongAmbient => 1.0,
    }
}

/// The time at which the mean charge of most of the scene, its wall (0.6 at 2.4 m), is that of the full well: bright
/// objects clip long before.
pub(super) fn longest_us(model: &CameraModel, light: Light) -> f64 {
    let rate = 0.6 * model.radiometric_electrons_per_us * (ambient(light) + 1.0 / (2.4 * 2.4));
    FullWell::of(model).capacity_electrons / rate
}

pub(super) fn simulation(
    name: &str,
    model: &CameraModel,
    light: Light,
    times_us: &[f64],
    (frames, seed): (u32, u64),
) -> Result<Simulation, ExperimentError> {
    let mut scene = Scene::builtin(name)?;
    scene.ambient = ambient(light);
    if let ("wall-sweep", [wall]) = (name, scene.objects.as_mut_slice()) {
        // Where the desk's wall stands, so that the sweep covers the desk's times.
        wall.center_m[2] = 2.4;
    }
    scene.runs.truncate(1);
    for run in &mut scene.runs {
        run.registers = None;
        run.integration_times_us = times_us.to_vec();
        run.frames_per_time = frames;
        // Settled: ten times the slowest warm-up.
        run.skip_frames = 300;
    }
    Ok(Simulation::new(model.clone(), scene, seed)?)
}

/// Renders every frame, with clipped pixels flagged as the reader of a recording does.
pub(super) fn for_each(
    simulation: &Simulation,
    mut visit: impl FnMut(&SimulatedFrame) -> Result<(), ExperimentError>,
) -> Result<(), ExperimentError> {
    let clip_dn = (CLIPPED_SHARE * simulation.model().clip_dn()) as f32;
    let mut out = SimulatedFrame::new(simulation.shape());
    for index in 0..simulation.len() {
        simulation.render_frame(index, &mut out)?;
        for bin in out.frame.phase_samples.iter().flatten() {
            for (flags, &value) in out.frame.flags.values_mut().iter_mut().zip(bin.values()) {
                flags.set(PixelFlags::SATURATED, value >= clip_dn || flags.contains(PixelFlags::SATURATED));
            }
        }
        visit(&out)?;
    }
    Ok(())
}
