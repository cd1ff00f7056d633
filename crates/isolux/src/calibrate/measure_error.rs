//! Why a frame cannot be measured, and why recordings do not fit together.

use crate::advice::Advice;
use crate::frame::{LensError, Shape, ShapeError};
use crate::standardize::StandardizeError;

/// Why a frame cannot be measured.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MeasureError {
    /// A frame of an exposure sweep without one known integration time for all pixels.
    #[error(
        "frame {frame}: integration time is {found}, one known time for the whole frame expected: \
             a sweep varies the time from frame to frame"
    )]
    NoSingleTime {
        /// Frame number, from 0.
        frame: usize,
        /// What was found, in words.
        found: &'static str,
    },
    /// A frame of a distance sweep without distances.
    #[error(
        "frame {frame}: no distance channel found, one expected: a distance sweep is measured against it"
    )]
    NoDistance {
        /// Frame number, from 0.
        frame: usize,
    },
    /// A frame without a pose in a recording whose poses were announced.
    #[error("frame {frame}: no pose (`world_from_camera`) found, one for every frame expected")]
    NoPose {
        /// Frame number, from 0.
        frame: usize,
    },
    /// A pose that is not a rigid transform.
    #[error(
        "frame {frame}: `world_from_camera` is no rigid transform: a rotation (orthonormal, no mirror), a translation \
         in metres and a last row of 0 0 0 1 expected"
    )]
    NotRigid {
        /// Frame number, from 0.
        frame: usize,
    },
    /// A frame whose planes differ in shape.
    #[error("frame {frame}: {source}")]
    Shape {
        /// Frame number, from 0.
        frame: usize,
        /// The plane.
        source: ShapeError,
    },
    /// A frame of a target without labels.
    #[error(
        "frame {frame}: no target channel found, one expected: its labels say which pixels are one material"
    )]
    NoTarget {
        /// Frame number, from 0.
        frame: usize,
    },
    /// A recording of a moving camera without intrinsics.
    #[error(
        "no intrinsics {{fx, fy, cx, cy}} of the recording found, expected: the rays of a moving camera are \
         computed from them"
    )]
    NoIntrinsics,
    /// A lens that does not fit the frames.
    #[error("frame {frame}: {source}")]
    Lens {
        /// Frame number, from 0.
        frame: usize,
        /// What does not fit.
        source: LensError,
    },
    /// A recording of a moving camera of whose lens only a table of rays is known.
    #[error(
        "a table of rays found, but the surfaces that a moving camera sees are followed from frame to frame through its \
         lens: intrinsics or beam angles expected"
    )]
    OnlyRays,
    /// A frame that the response cannot make linear.
    #[error("linear amplitude: {0}")]
    Linear(#[from] StandardizeError),
}

impl MeasureError {
    /// What the user can do about it.
    #[must_use]
    pub fn advice(&self) -> Option<Advice> {
        match self {
            Self::NoIntrinsics | Self::OnlyRays => Some(Advice::GiveIntrinsics),
            _ => None,
        }
    }
}

/// Recordings of one kind whose images differ in shape.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{recording}: images of {found} found, {expected}, as in {first} expected")]
pub struct UnlikeShapes {
    /// The recording.
    pub recording: String,
    /// Shape of its images.
    pub found: Shape,
    /// Shape of the first recording's images.
    pub expected: Shape,
    /// The first recording.
    pub first: String,
}

/// The shape that all of these recordings share; `None` without a recording.
///
/// # Errors
/// [`UnlikeShapes`] names the first that differs.
pub(super) fn common_shape<'a>(
    mut recordings: impl Iterator<Item = (&'a str, Shape)>,
) -> Result<Option<Shape>, UnlikeShapes> {
    let Some((first, expected)) = recordings.next() else { return Ok(None) };
    match recordings.find(|(_, shape)| *shape != expected) {
        None => Ok(Some(expected)),
        Some((recording, found)) => {
            let [recording, first] = [recording, first].map(str::to_owned);
            Err(UnlikeShapes { recording, found, expected, first })
        }
    }
}
