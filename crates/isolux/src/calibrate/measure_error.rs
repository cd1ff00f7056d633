//! Why a frame cannot be measured, and recordings of unlike formats.

use crate::advice::Advice;
use crate::frame::{Shape, ShapeError};
use crate::standardize::StandardizeError;

/// Why a frame of a recording cannot serve its sweep.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MeasureError {
    /// Frames without a single integration time in a sweep.
    #[error(
        "frame {frame}: integration time is {found}, one known time for the whole frame expected: \
             a sweep varies the time from frame to frame"
    )]
    NoSingleTime {
        /// Frame number, from 0.
        frame: usize,
        /// What is there.
        found: &'static str,
    },
    /// A distance sweep without distances.
    #[error(
        "frame {frame}: no distance channel found, one expected: a distance sweep is measured against it"
    )]
    NoDistance {
        /// Frame number, from 0.
        frame: usize,
    },
    /// A frame without a pose where poses are said to be recorded.
    #[error("frame {frame}: no pose (`world_from_camera`) found, one for every frame expected")]
    NoPose {
        /// Frame number, from 0.
        frame: usize,
    },
    /// A pose that is not rigid.
    #[error(
        "frame {frame}: `world_from_camera` is no rigid transform: a rotation (orthonormal, no mirror), a translation \
         in metres and a last row of 0 0 0 1 expected"
    )]
    NotRigid {
        /// Frame number, from 0.
        frame: usize,
    },
    /// A frame whose planes do not fit together.
    #[error("frame {frame}: {source}")]
    Shape {
        /// Frame number, from 0.
        frame: usize,
        /// The plane.
        source: ShapeError,
    },
    /// A target's recording without labels.
    #[error(
        "frame {frame}: no target channel found, one expected: its labels say which pixels are one material"
    )]
    NoTarget {
        /// Frame number, from 0.
        frame: usize,
    },
    /// A camera that moves, without intrinsics.
    #[error(
        "no intrinsics {{fx, fy, cx, cy}} of the recording found, expected: a camera that moves sees its surfaces \
         through them"
    )]
    NoIntrinsics,
    /// A frame that the response cannot make linear.
    #[error("linear amplitude: {0}")]
    Linear(#[from] StandardizeError),
}

impl MeasureError {
    /// What the user can do about it.
    #[must_use]
    pub fn advice(&self) -> Option<Advice> {
        match self {
            Self::NoIntrinsics => Some(Advice::GiveIntrinsics),
            _ => None,
        }
    }
}

/// Recordings of one kind whose images differ in format.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{recording}: images of {found} found, {expected}, as in {first} expected")]
pub struct UnlikeShapes {
    /// The recording.
    pub recording: String,
    /// Its format.
    pub found: Shape,
    /// That of the first recording.
    pub expected: Shape,
    /// The first recording.
    pub first: String,
}

/// The format that all of these recordings share; `None` without a recording.
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
