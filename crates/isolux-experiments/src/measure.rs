//! Rendering scenes frame by frame, and means over windows of them.

use isolux::statistics::quantile;
use isolux::{Frame, IntegrationTime, Shape, Window};
use isolux_camera::{CameraModel, Scene, SimulatedFrame, Simulation, Truth};

use crate::error::ExperimentError;

/// Side of the paper's measurement windows, pixels.
pub(crate) const WINDOW_PX: usize = 20;

/// A built-in scene before its own camera.
pub(crate) fn simulation(scene: &str, seed: u64) -> Result<Simulation, ExperimentError> {
    simulation_of(Scene::builtin(scene)?, seed)
}

/// A scene, built-in or changed, before its own camera.
pub(crate) fn simulation_of(scene: Scene, seed: u64) -> Result<Simulation, ExperimentError> {
    let model = CameraModel::preset(&scene.camera)?;
    Ok(Simulation::new(model, scene, seed)?)
}

/// The first frame that is recorded at this integration time; `scene` is the name for the error.
pub(crate) fn frame_at(
    simulation: &Simulation,
    scene: &'static str,
    integration_time_us: f64,
) -> Result<SimulatedFrame, ExperimentError> {
    let planned = simulation.frames().iter();
    let index =
        planned.map(|frame| frame.integration_time_us).position(|time_us| time_us == integration_time_us);
    let index =
        index.ok_or(ExperimentError::Scene { scene, missing: "a frame at the pictured integration time" })?;
    let mut out = SimulatedFrame::new(simulation.shape());
    simulation.render_frame(index, &mut out)?;
    Ok(out)
}

/// The regions whose means are drawn: the whole image, then windows of 20×20 from the centre outwards.
pub(crate) fn regions(shape: Shape) -> [(&'static str, Window); 4] {
    let at = |quarters: usize| Window {
        top: quarters * shape.height.saturating_sub(WINDOW_PX) / 4,
        left: quarters * shape.width.saturating_sub(WINDOW_PX) / 4,
        height: WINDOW_PX.min(shape.height),
        width: WINDOW_PX.min(shape.width),
    };
    [("whole image", Window::whole(shape)), ("centre", at(2)), ("half way out", at(1)), ("corner", at(0))]
}

/// Renders every frame on all threads and visits them in their order.
///
/// # Errors
/// Those of the camera and of `visit`.
pub(crate) fn for_each(
    simulation: &Simulation,
    mut visit: impl FnMut(usize, &SimulatedFrame) -> Result<(), ExperimentError>,
) -> Result<(), ExperimentError> {
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

/// The frame's one integration time, µs, where it has one.
pub(crate) fn time_us(frame: &Frame) -> Option<f64> {
    match frame.integration_time_us {
        IntegrationTime::PerFrame(time_us) => Some(time_us),
        _ => None,
    }
}

/// Share of its linear amplitude that a pixel keeps: 5 % quantile, so of the pixels that saturate most.
pub(crate) fn kept(truth: &Truth) -> f64 {
    let pairs = truth.noise_free_amplitude.values().iter().zip(truth.linear_amplitude.values());
    let mut ratios: Vec<f64> =
        pairs.map(|(with, without)| f64::from(with / without)).filter(|ratio| ratio.is_finite()).collect();
    quantile(&mut ratios, 0.05).unwrap_or(f64::NAN)
}
