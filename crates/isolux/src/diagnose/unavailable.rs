//! What a recording does not tell, and why.

use serde::Serialize;

use super::limits::MINIMUM_ROWS;
use crate::numerics::regression::RegressionError;

/// A figure, or the reason why this recording does not determine it. In JSON the figure itself, or
/// `{"unavailable": "time_constant", "because": "…"}`.
pub type Outcome<T> = Result<T, Unavailable>;

/// Why something is not told. Never a guess in its place.
#[derive(Clone, Debug, PartialEq, Serialize, thiserror::Error)]
#[serde(tag = "unavailable", rename_all = "snake_case")]
#[non_exhaustive]
pub enum Unavailable {
    /// Nothing was there to look at.
    #[error("no pixel of any frame is valid")]
    NoValidPixels,
    /// Exposures cannot be told apart.
    #[error(
        "the integration times are not recorded; if the camera changed them, the other figures suffer from it"
    )]
    TimeUnknown,
    /// There is but one exposure.
    #[error("all integration times are equal ({time_us} µs); record a still scene at several")]
    TimeConstant {
        /// That time, µs.
        time_us: f64,
    },
    /// Times differ between pixels, but hardly any pixel has two.
    #[error(
        "the integration times differ from pixel to pixel, and hardly any pixel is seen at two of them: the camera gives \
         the short time to what is bright, so time and material go together"
    )]
    TimeFollowsMaterial,
    /// Pixels are seen at several times, but at other distances each time.
    #[error(
        "the scene moved: {:.0} % of what was seen is elsewhere than in the first frames; record a still scene at \
         several integration times",
        100.0 * share
    )]
    SceneMoved {
        /// Share of the pixels whose distance changed, 0..=1.
        share: f64,
    },
    /// There is no distance channel.
    #[error("there is no distance channel")]
    NoDistance,
    /// An exponent over this span would be noise.
    #[error("the distances of {of} span a factor of {found:.2} only, {minimum:.2} is needed")]
    DistanceSpanTooSmall {
        /// Whose distances.
        of: String,
        /// 95 % over 5 % quantile.
        found: f64,
        /// Factor that is needed.
        minimum: f64,
    },
    /// Nothing says which pixels show one material.
    #[error(
        "nothing says which pixels show one material: far things may be darker or brighter than near ones. Move \
         one flat target through the distances and label it in a `target` channel"
    )]
    MaterialUnknown,
    /// The vendor amplitude is the raw one times something: no reflectivity.
    #[error(
        "nothing says which pixels show one material: the vendor amplitude is the raw one, scaled without regard \
         to distance, and so no measure of material. Move one flat target through the distances and label it in \
         a `target` channel"
    )]
    VendorIsNoMaterial,
    /// Too few values.
    #[error("{found} usable pixels, {needed} are needed")]
    TooFewPixels {
        /// Pixels found.
        found: usize,
        /// Pixels needed.
        needed: usize,
    },
    /// An effect cannot be told from others.
    #[error("{effect} varies only together with {others}: its effect cannot be told from theirs")]
    Confounded {
        /// The effect.
        effect: String,
        /// What it goes with.
        others: String,
    },
    /// All valid pixels lie in one corner.
    #[error(
        "the usable pixels lie in {blocks} of 64 blocks of the image: too few to tell how far they can be trusted"
    )]
    TooFewBlocks {
        /// Blocks that hold usable pixels.
        blocks: usize,
    },
    /// A channel that the figure needs is not there.
    #[error("there is no {channel}")]
    NoChannel {
        /// Name of the channel.
        channel: &'static str,
    },
    /// The amplitude was computed from the bins.
    #[error("the amplitude is computed from the phase samples by eq. 1: comparing the two says nothing")]
    AmplitudeFromPhaseSamples,
}

impl From<RegressionError> for Unavailable {
    fn from(error: RegressionError) -> Self {
        match error {
            RegressionError::TooFewRows { found, unknowns } => {
                Self::TooFewPixels { found, needed: (unknowns + 1).max(MINIMUM_ROWS) }
            }
            RegressionError::Row { row, .. } => Self::TooFewPixels { found: row, needed: MINIMUM_ROWS },
            RegressionError::Constant { column } => {
                Self::Confounded { effect: column, others: "the material".to_owned() }
            }
            RegressionError::Dependent { column, others } => {
                Self::Confounded { effect: column, others: others.join(" and ") }
            }
            RegressionError::TooFewClusters { found, .. } => Self::TooFewBlocks { blocks: found },
        }
    }
}
