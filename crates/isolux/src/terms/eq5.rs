//! `eq5`: eq. 5 of the paper, `A_dist = I_src / ((2d)² + 1)`, d in metres.

use super::{DistanceGain, DistanceLaw};

/// Multiplier `((2d)² + 1) / ((2 d_ref)² + 1)`, for all distances in metres.
#[must_use]
pub fn distance_law(reference_distance_m: f64) -> DistanceLaw {
    let at_reference = 4.0 * reference_distance_m * reference_distance_m + 1.0;
    DistanceGain::unbounded([1.0 / at_reference, 0.0, 4.0 / at_reference, 0.0]).into()
}
