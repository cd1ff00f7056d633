//! Why the camera's motion could not be estimated.

use std::fmt;

use super::align::Lost;
use crate::numerics::statistics::median;

/// Why the motion could not be estimated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotionRefusal {
    /// Frames that could be aligned.
    pub aligned: usize,
    /// All frames.
    pub frames: usize,
    /// The obstacle in most of the other frames.
    pub reason: MotionObstacle,
}

/// Why a frame cannot be aligned.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum MotionObstacle {
    /// Too few surfaces of earlier frames were in sight.
    TooFewSurfaces {
        /// Number found.
        found: usize,
    },
    /// The surfaces let the camera slide along them.
    Slides {
        /// Root mean square of the surfaces' resistance to the easiest motion; 1 where all face it.
        hold: f64,
    },
    /// The surfaces do not fit any one motion.
    Disagrees {
        /// Scatter about their places, in expected standard errors.
        residual: f64,
        /// Share of the surfaces that agree, 0..=1.
        agreeing: f64,
    },
}

impl fmt::Display for MotionRefusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { aligned, frames, reason } = self;
        write!(f, "the camera's motion cannot be estimated (only {aligned} of {frames} frames aligned): ")?;
        match reason {
            MotionObstacle::TooFewSurfaces { found } => {
                write!(f, "{found} surfaces of earlier frames in sight; move more slowly, with more light")
            }
            MotionObstacle::Slides { hold } => write!(
                f,
                "the surfaces let the camera slide along them (hold {hold:.3}): a single plane or a ball; show a \
                 corner of a room, or record the poses"
            ),
            MotionObstacle::Disagrees { residual, agreeing } => write!(
                f,
                "surfaces scatter by {residual:.1}σ about their places, {:.0} % agree; move more slowly, let nothing \
                 else move, or record the poses",
                100.0 * agreeing
            ),
        }
    }
}

impl MotionObstacle {
    /// The most frequent obstacle, with its median figures.
    pub(super) fn most_frequent(lost: &[Lost]) -> Self {
        let middle = |pick: &dyn Fn(&Lost) -> Option<f64>| {
            let mut values: Vec<f64> = lost.iter().filter_map(pick).collect();
            let count = values.len();
            median(&mut values).map(|value| (count, value))
        };
        let unknown = middle(&|lost| match lost {
            Lost::Unknown { surfaces } => Some(*surfaces as f64),
            _ => None,
        });
        let slides = middle(&|lost| match lost {
            Lost::Slides { hold } => Some(*hold),
            _ => None,
        });
        let disagrees = middle(&|lost| match lost {
            Lost::Disagrees { scale, .. } => Some(*scale),
            _ => None,
        });
        let agreeing = middle(&|lost| match lost {
            Lost::Disagrees { agreeing, .. } => Some(*agreeing),
            _ => None,
        });
        let count = |found: &Option<(usize, f64)>| found.map_or(0, |(count, _)| count);
        match (slides, disagrees) {
            (Some((most, hold)), _) if most >= count(&disagrees).max(count(&unknown)) => {
                Self::Slides { hold }
            }
            (_, Some((most, residual))) if most >= count(&unknown) => {
                Self::Disagrees { residual, agreeing: agreeing.map_or(0.0, |(_, share)| share) }
            }
            _ => Self::TooFewSurfaces { found: unknown.map_or(0.0, |(_, found)| found) as usize },
        }
    }
}
