//! `square`: the amplitude falls with the square of the distance (Oprisescu et al.). Textbook physics for a
//! point source beside the lens; near the camera, an extended LED ring departs from it.

use super::{DistanceGain, DistanceLaw};

/// Multiplier `(d / d_ref)²`, for all distances in metres.
#[must_use]
pub fn distance_law(reference_distance_m: f64) -> DistanceLaw {
    DistanceGain::unbounded([0.0, 0.0, 1.0 / (reference_distance_m * reference_distance_m), 0.0]).into()
}
