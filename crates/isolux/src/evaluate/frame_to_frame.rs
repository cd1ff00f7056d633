//! Variation of the level of still pixels from frame to frame.

use serde::Serialize;

use super::input::EvaluationFrame;
use super::outcome::{Outcome, Unavailable};
use crate::common_factor::{Course, Grid, Look, Times};
use crate::frame::Shape;

/// Population coefficient of variation, over frames, of the factor that all still pixels share.
///
/// The factor of a frame is the median ratio of its bright pixels to those of one other frame, where their distance
/// stayed and the parts of the image agree. Exposures that change make it vary, whether their times are recorded or
/// not; noise and movement do not.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FrameToFrame {
    /// Standard deviation / mean over frames, dimensionless.
    pub cv: f64,
    /// Frames that could be compared.
    pub frames: u32,
    /// Those frames / all frames, 0..=1.
    pub valid_fraction: f64,
}

/// Follows the factor frame by frame.
#[derive(Clone, Debug)]
pub(super) struct FrameToFrameMeter {
    grid: Grid,
    course: Course,
    frames: u32,
}

impl FrameToFrameMeter {
    pub(super) fn new(shape: Shape) -> Self {
        let grid = Grid::new(shape);
        Self { grid, course: Course::new(grid, Times::Ignored), frames: 0 }
    }

    /// Takes in a frame and its usable values; NaN = unusable.
    pub(super) fn push(&mut self, usable: &[f32], frame: &EvaluationFrame<'_>) {
        let value = |pixel: usize| usable[pixel];
        self.course.push(Look::new(self.grid, value, frame.distance_m, frame.integration_time_us));
        self.frames = self.frames.saturating_add(1);
    }

    pub(super) fn finish(&self) -> Outcome<FrameToFrame> {
        let (cv, frames) = self.course.variation().ok_or(Unavailable::NothingStandsStill)?;
        Ok(FrameToFrame { cv, frames, valid_fraction: f64::from(frames) / f64::from(self.frames) })
    }
}
