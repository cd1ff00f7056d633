//! Why a frame cannot be standardized.

use crate::advice::Advice;
use crate::denoise::DenoiseError;
use crate::frame::{Shape, ShapeError};
use crate::step_names::TimeStep;

/// Why a frame cannot be standardized.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum StandardizeError {
    /// Planes that do not fit together.
    #[error(transparent)]
    Shape(#[from] ShapeError),
    /// The integration time that the plan needs is missing.
    #[error(
        "the integration time is unknown (NaN or missing), a positive number of µs expected: the time step needs it"
    )]
    TimeUnknown,
    /// The distance that the plan needs is missing.
    #[error("no distance found, a plane of metres expected: the distance step needs it")]
    DistanceMissing,
    /// The channel from which the response computes the fill of a pixel is missing.
    #[error("no {channel} found, one value for each pixel expected: the response's tier needs it")]
    FillMissing {
        /// The channel.
        channel: &'static str,
    },
    /// The response's map was fitted on frames of another shape.
    #[error(
        "the frame is {found}, {expected} expected, the shape of the scene that the response's tier `pixel` was \
         fitted on: it holds for that scene alone"
    )]
    AnotherScene {
        /// Shape of the frame.
        found: Shape,
        /// Shape of the map.
        expected: Shape,
    },
    /// The illumination profile was fitted on frames of another shape.
    #[error(
        "a frame of {found} found, {expected} expected: the illumination profile holds for that format alone"
    )]
    ProfileFormat {
        /// Shape of the frame.
        found: Shape,
        /// Shape that the profile was fitted on.
        expected: Shape,
    },
    /// The rays were computed for frames of another shape.
    #[error("a frame of {found} found, {expected} expected: the lens was given for that format")]
    LensFormat {
        /// Shape of the frame.
        found: Shape,
        /// Shape that the rays were computed for.
        expected: Shape,
    },
}

impl From<DenoiseError> for StandardizeError {
    fn from(error: DenoiseError) -> Self {
        match error {
            DenoiseError::Shape(error) => Self::Shape(error),
            DenoiseError::DistanceMissing => Self::DistanceMissing,
        }
    }
}

impl StandardizeError {
    /// What the user can do about it.
    #[must_use]
    pub fn advice(&self) -> Option<Advice> {
        match self {
            Self::TimeUnknown => Some(Advice::UseTimeStep(TimeStep::None)),
            _ => None,
        }
    }
}
