//! Distances beyond the ambiguity range, which the camera takes for near ones.

use super::decay::Position;

/// A frame whose distance is wrapped.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Wrapped {
    pub(super) frame: usize,
    pub(super) distance_m: f64,
}

/// From one position to the next, the distance falls to less than this share ...
const NEARER: f64 = 0.75;
/// ... and yet the amplitude does not grow. The square law would make it 1.8 times as large; saturation takes less from
/// it, unless the target comes from afar in one stride.
const BRIGHTER: f64 = 1.0;

/// The first position, in the order of recording, that is too dark for its distance.
pub(super) fn wrapped(positions: &[Position]) -> Option<Wrapped> {
    positions.windows(2).find_map(|pair| {
        let [(before_m, before_dn), (distance_m, amplitude_dn)] =
            [&pair[0], &pair[1]].map(|p| (p.mean(|m| m.distance_m), p.mean(|m| m.amplitude_dn)));
        let is_wrapped = distance_m < NEARER * before_m && amplitude_dn < BRIGHTER * before_dn;
        is_wrapped.then(|| Wrapped { frame: pair[1].frames.first().copied().unwrap_or(0), distance_m })
    })
}
