//! Settings of the evaluation.

use serde::Serialize;

use crate::frame::IntegrationTime;

/// Most pixels that the slope's sample may hold: its pairs take 8 bytes each, 67 MB for 4096 pixels.
const LARGEST_SAMPLE: usize = 4096;

/// Limits and sizes of the evaluation; the defaults serve every recording met so far.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct EvaluationSettings {
    /// Integration times less than this factor apart count as equal (> 1): cameras report them with jitter.
    pub same_time_ratio: f64,
    /// Pixels in the sample of the distance slope, at most 4096.
    pub slope_sample_pixels: usize,
    /// Factor that distances must span for a slope to be given: 1.2 makes d² differ by 44 %.
    pub minimum_distance_ratio: f64,
    /// Factor that the two distances of a pair must differ by: well above the distance noise, which flattens
    /// the slopes of close pairs.
    pub minimum_pair_distance_ratio: f64,
    /// Borders between the strata of the signal-to-noise ratio, ascending, dimensionless.
    pub snr_edges: Vec<f64>,
}

impl Default for EvaluationSettings {
    fn default() -> Self {
        Self {
            same_time_ratio: IntegrationTime::SAME_RATIO,
            slope_sample_pixels: 2048,
            minimum_distance_ratio: 1.2,
            minimum_pair_distance_ratio: 1.05,
            snr_edges: vec![5.0, 10.0, 20.0],
        }
    }
}

impl EvaluationSettings {
    pub(super) fn sample_capacity(&self) -> usize {
        self.slope_sample_pixels.min(LARGEST_SAMPLE)
    }
}
