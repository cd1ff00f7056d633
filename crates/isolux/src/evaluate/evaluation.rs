//! The figures of one recording.

use serde::Serialize;

use super::{
    CoverageStratum, DistanceSlope, FrameToFrame, HistogramDistance, ImageCv, Noise, OtsuShift, Outcome,
    PixelCv, SigmaCoverage, SnrStratum, ThresholdIou,
};

/// What an [`Evaluator`](super::Evaluator) found; each figure, or why the recording does not determine it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Evaluation {
    /// Frames evaluated.
    pub frames: u64,
    /// Height × width.
    pub pixels_per_frame: usize,
    /// Valid values / values of all frames, 0..=1; none without frames.
    pub valid_fraction: Option<f64>,
    /// Integration time of the reference frame, µs.
    pub reference_time_us: Option<f64>,
    /// Per-pixel coefficient of variation over integration times.
    #[serde(serialize_with = "crate::outcome_json::serialize")]
    pub pixel_cv: Outcome<PixelCv>,
    /// The same, by the raw amplitude's signal-to-noise ratio.
    #[serde(serialize_with = "crate::outcome_json::serialize")]
    pub pixel_cv_by_snr: Outcome<Vec<SnrStratum>>,
    /// Coefficient of variation of the image's mean over integration times.
    #[serde(serialize_with = "crate::outcome_json::serialize")]
    pub image_cv: Outcome<ImageCv>,
    /// Variation of the level of still pixels from frame to frame.
    #[serde(serialize_with = "crate::outcome_json::serialize")]
    pub frame_to_frame: Outcome<FrameToFrame>,
    /// Slope of ln A on ln d.
    #[serde(serialize_with = "crate::outcome_json::serialize")]
    pub distance_slope: Outcome<DistanceSlope>,
    /// Overlap of the masks of one threshold over integration times.
    #[serde(serialize_with = "crate::outcome_json::serialize")]
    pub threshold_iou: Outcome<ThresholdIou>,
    /// Movement of Otsu's threshold over integration times.
    #[serde(serialize_with = "crate::outcome_json::serialize")]
    pub otsu_shift: Outcome<OtsuShift>,
    /// W1 distance of log histograms over integration times.
    #[serde(serialize_with = "crate::outcome_json::serialize")]
    pub histogram_distance: Outcome<HistogramDistance>,
    /// Relative noise of a single frame.
    #[serde(serialize_with = "crate::outcome_json::serialize")]
    pub noise: Outcome<Noise>,
    /// Predicted standard deviations beside the differences between frames of one integration time.
    #[serde(serialize_with = "crate::outcome_json::serialize")]
    pub sigma_coverage: Outcome<SigmaCoverage>,
    /// The same, by the raw amplitude's signal-to-noise ratio.
    #[serde(serialize_with = "crate::outcome_json::serialize")]
    pub sigma_coverage_by_snr: Outcome<Vec<CoverageStratum>>,
}
