//! Rendering scenes frame by frame, and means over windows of them.

use isolux::{Frame, Window};
use isolux_camera::{CameraModel, Scene, SimulatedFrame, Simulation};

use crate::error::PaperError;

/// A built-in scene before its own camera.
pub(crate) fn simulation(scene: &str, seed: u64) -> Result<Simulation, PaperError> {
    let scene = Scene::builtin(scene)?;
    let model = CameraModel::preset(&scene.camera)?;
    Ok(Simulation::new(model, scene, seed)?)
}

/// Renders every frame on all threads and visits them in their order.
///
/// # Errors
/// Those of the camera and of `visit`.
pub(crate) fn for_each(
    simulation: &Simulation,
    mut visit: impl FnMut(usize, &SimulatedFrame) -> Result<(), PaperError>,
) -> Result<(), PaperError> {
    let (mut batch, step) = (Vec::new(), 4 * rayon::current_num_threads().max(1));
    for start in (0..simulation.len()).step_by(step) {
        let indices = start..(start + step).min(simulation.len());
        simulation.render_frames(indices.clone(), &mut batch)?;
        for (index, simulated) in indices.zip(&batch) {
            visit(index, simulated)?;
        }
    }
    Ok(())
}

/// Mean of the valid amplitudes in the window, DN; NaN where there are none.
pub(crate) fn mean_amplitude(frame: &Frame, window: Window) -> f64 {
    mean(frame.amplitude.values(), window.indices(frame.shape()).filter(|&index| frame.is_valid(index)))
}

/// Mean of the distances of the valid pixels in the window, m; NaN where there are none.
pub(crate) fn mean_distance_m(frame: &Frame, window: Window) -> f64 {
    let Some(distance_m) = &frame.distance_m else { return f64::NAN };
    let valid = |index: &usize| frame.is_valid(*index) && distance_m.values()[*index] > 0.0;
    mean(distance_m.values(), window.indices(frame.shape()).filter(valid))
}

/// Mean of the values at `indices` that are finite; NaN where there are none.
pub(crate) fn mean(values: &[f32], indices: impl Iterator<Item = usize>) -> f64 {
    let finite = indices.map(|index| f64::from(values[index])).filter(|value| value.is_finite());
    let (sum, count) = finite.fold((0.0, 0.0), |(sum, count), value| (sum + value, count + 1.0));
    sum / count
}

/// Coefficient of variation (population) of the finite values; NaN for fewer than two.
pub(crate) fn coefficient_of_variation(values: &[f64]) -> f64 {
    let finite: Vec<f64> = values.iter().copied().filter(|value| value.is_finite()).collect();
    if finite.len() < 2 {
        return f64::NAN;
    }
    let count = finite.len() as f64;
    let mean = finite.iter().sum::<f64>() / count;
    (finite.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / count).sqrt() / mean
}
