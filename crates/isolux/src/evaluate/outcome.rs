//! The value of a figure, or the reason why there is none.

use serde::Serialize;

/// A metric, or the reason why this recording does not determine it. In JSON the value itself, or
/// `{"unavailable": "time_constant", "because": "…"}`.
pub type Outcome<T> = Result<T, Unavailable>;

/// Why a metric is not there. Never a default value in its place.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, thiserror::Error)]
#[serde(tag = "unavailable", rename_all = "snake_case")]
#[non_exhaustive]
pub enum Unavailable {
    /// Nothing was evaluated.
    #[error("there are no frames")]
    NoFrames,
    /// No pixel may enter.
    #[error("no pixel is valid where it is needed")]
    NoValidPixels,
    /// Exposures cannot be told apart.
    #[error("the integration times are not recorded")]
    TimeUnknown,
    /// There is but one exposure.
    #[error("all integration times are equal; record a still scene at several")]
    TimeConstant,
    /// Frames cannot be told apart by their exposure.
    #[error("every pixel has an integration time of its own, so frames have none to be compared by")]
    TimePerPixel,
    /// Every pixel was seen (validly) at one integration time only.
    #[error("no pixel is valid at two different integration times")]
    NoPixelAtTwoTimes,
    /// `set_reference` was not called, or not with a frame of one known integration time.
    #[error("no reference frame of one known integration time was given")]
    NoReference,
    /// Otsu's rule needs two different values.
    #[error("the reference frame has no two different values where it is valid, so no threshold divides it")]
    NoThreshold,
    /// No pixel reaches the threshold, neither in the reference nor in any other frame.
    #[error("no pixel lies above the threshold in any compared frame")]
    EmptyMasks,
    /// No two frames share enough pixels whose distance stayed.
    #[error("no two frames show enough of the same surfaces at the same distances in the same pixels")]
    NothingStandsStill,
    /// There is no distance channel.
    #[error("there is no distance channel")]
    NoDistance,
    /// The target channel is there, but 0 wherever the amplitude and the distance are valid.
    #[error("no valid pixel of the target channel is labelled")]
    NoLabelledPixels,
    /// A slope over this span would be noise.
    #[error(
        "pixels of one target and one integration time span a factor of {found:.2} in distance, \
         {minimum:.2} is needed"
    )]
    DistanceSpanTooSmall {
        /// 95 % over 5 % quantile of the distances of the widest group.
        found: f64,
        /// Factor that is needed.
        minimum: f64,
    },
    /// Too few pairs of pixels differ enough in distance.
    #[error("{found} pairs of pixels differ enough in distance, {minimum} are needed")]
    TooFewPairs {
        /// Pairs found.
        found: usize,
        /// Pairs needed.
        minimum: usize,
    },
    /// Neither consecutive frames nor neighbouring pixels are there in sufficient number.
    #[error("too few valid pixels repeat from frame to frame or stand side by side to estimate the noise")]
    NoNoiseEstimate,
    /// The signal-to-noise ratio of a pixel needs frames that repeat one integration time.
    #[error("too few consecutive frames share an integration time to know the pixels' signal-to-noise ratio")]
    NoRepeatedFrames,
    /// The noise to be compared with is 0: simulated without noise, or hidden by the quantization.
    #[error("no noise is visible before, so none can be compared")]
    NoiseIsZero,
    /// No standard deviations were predicted.
    #[error(
        "no standard deviation was predicted: the noise of the amplitude is not known, or this is the raw amplitude"
    )]
    NoSigma,
    /// One estimate is temporal, the other spatial.
    #[error("the noise before and after was estimated by different methods")]
    NoiseMethodsDiffer,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_reason_is_readable_by_program_and_by_person() {
        #[derive(Serialize)]
        struct Holder {
            #[serde(serialize_with = "crate::outcome_json::serialize")]
            slope: Outcome<f64>,
        }
        let reason = Unavailable::DistanceSpanTooSmall { found: 1.05, minimum: 1.2 };
        let json = serde_json::to_value(Holder { slope: Err(reason) }).unwrap();
        assert_eq!(json["slope"]["unavailable"], "distance_span_too_small");
        assert_eq!(json["slope"]["found"], 1.05);
        assert!(json["slope"]["because"].as_str().unwrap().contains("1.20 is needed"));
        assert_eq!(serde_json::to_value(Holder { slope: Ok(2.0) }).unwrap()["slope"], 2.0);
    }
}
