//! Frames as a camera without noise would deliver them.

use isolux::Frame;
use isolux_camera::{CameraModel, SimulatedFrame};

/// The frame as a camera without noise would deliver it: amplitude with saturation, true distance, wrapped. Its flags
/// are those of the noisy frame, so that the same pixels count.
pub(super) fn without_noise(simulated: &SimulatedFrame, model: &CameraModel) -> Frame {
    let range_m = model.ambiguity_range_m();
    let mut frame = simulated.frame.clone();
    frame.amplitude = simulated.truth.noise_free_amplitude.clone();
    let mut distance_m = simulated.truth.true_distance_m.clone();
    for distance in distance_m.values_mut() {
        *distance = (f64::from(*distance) % range_m) as f32;
    }
    frame.distance_m = Some(distance_m);
    frame
}
