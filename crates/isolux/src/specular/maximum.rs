//! The largest value of an image.

/// Largest positive finite value, or 0. In lanes, so that the loop vectorizes.
pub(super) fn maximum(values: &[f32]) -> f32 {
    let mut lanes = [0.0f32; 16];
    for chunk in values.chunks(lanes.len()) {
        for (largest, &value) in lanes.iter_mut().zip(chunk) {
            *largest = if value > *largest && value < f32::INFINITY { value } else { *largest };
        }
    }
    lanes.into_iter().fold(0.0, f32::max)
}
