//! What an assessment is asked for, and what it says.

use isolux::Calibration;
use isolux::evaluate::Comparison;

use super::rivals::Standing;

/// Which pixels count.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Pixels {
    /// Before and after, those with a value.
    #[default]
    Valid,
    /// Before and after the same: those with a standardized value and neither LOW_SIGNAL nor SATURATED.
    Trusted,
}

/// How to go about it.
#[derive(Clone, Copy, Debug, Default)]
pub struct AssessOptions<'a> {
    /// The calibration that the chain was planned with.
    pub calibration: Option<&'a Calibration>,
    /// Which pixels count.
    pub pixels: Pixels,
    /// Evaluate the textbook's and the paper's chain on the same frames, as far as recording and calibration allow
    /// them and they do not do the same.
    pub rivals: bool,
}

/// What the frames of a recording say before and after standardization.
#[derive(Clone, Debug)]
pub struct Assessment {
    /// Number of frames.
    pub frames: usize,
    /// The figures before and after.
    pub comparison: Comparison,
    /// The chains beside the chosen one.
    pub rivals: Vec<Standing>,
    /// Mean over the counted pixels at each integration time, increasing.
    pub means: Vec<MeanAtTime>,
    /// A few frames that show the range: those of the shortest, the reference and the longest time, or the first,
    /// middle and last.
    pub shown_frames: Vec<usize>,
}

/// Means of the frames of one integration time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeanAtTime {
    /// The time, µs.
    pub time_us: f64,
    /// Raw, DN.
    pub before_dn: f64,
    /// Standardized, DN.
    pub after_dn: f64,
}
