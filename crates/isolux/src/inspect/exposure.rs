//! Exposures that changed unrecorded, and frames that were scaled one by one.

use super::suspicion::Suspicion;
use crate::common_factor::{Course, Grid, Look, Spans, Times};
use crate::frame::{Frame, Shape};

/// Watches what all pixels share.
#[derive(Clone, Debug)]
pub(super) struct Exposures {
    grid: Grid,
    course: Course,
    spans: Spans,
}

impl Exposures {
    pub(super) fn new(shape: Shape) -> Self {
        let grid = Grid::new(shape);
        Self { grid, course: Course::new(grid, Times::Explain), spans: Spans::default() }
    }

    pub(super) fn push(&mut self, frame: &Frame) {
        self.course.push(Look::of_frame(self.grid, frame));
        self.spans.push(frame);
    }

    /// The stretch, where there is one: it explains the factor too.
    pub(super) fn finish(&self) -> Option<Suspicion> {
        let changed = self.course.unexplained();
        let stretched = self.spans.stretched(changed.is_some());
        stretched.map(Suspicion::ScaledByFrame).or(changed.map(Suspicion::ExposureChanged))
    }
}
