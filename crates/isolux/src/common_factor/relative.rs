//! What frames have relative to each other, as multipliers that make them comparable.

use std::sync::Arc;

use super::course::{Course, Times};
use super::look::{Grid, Look};
use crate::frame::{Frame, Shape};

/// Share of the frames that must be comparable with each other.
const LEAST_SHARE: f64 = 0.5;

/// One multiplier for each frame of a recording, which takes out the factor that all still pixels share. They are
/// relative to the median frame: they say nothing of the exposure itself.
#[derive(Clone, Debug, PartialEq)]
pub struct RelativeExposure {
    /// NaN where nothing stands still.
    multipliers: Arc<[f32]>,
}

impl RelativeExposure {
    /// The multiplier of a frame, counted from 0; NaN where nothing in it stands still.
    #[must_use]
    pub fn multiplier(&self, frame: usize) -> f32 {
        self.multipliers.get(frame).copied().unwrap_or(f32::NAN)
    }

    /// Least and largest factor that a frame has, relative to the median frame.
    #[must_use]
    pub fn range(&self) -> [f32; 2] {
        let factors = || self.multipliers.iter().filter(|m| !m.is_nan()).map(|m| 1.0 / m);
        [factors().fold(f32::INFINITY, f32::min), factors().fold(0.0, f32::max)]
    }

    /// Number of frames that have a multiplier, and of those that have none.
    #[must_use]
    pub fn frames(&self) -> [usize; 2] {
        let without = self.multipliers.iter().filter(|multiplier| multiplier.is_nan()).count();
        [self.multipliers.len() - without, without]
    }
}

/// Finds the multipliers from all frames of a recording, one after the other. It keeps a sample of a few frames, and a
/// number for each.
#[derive(Clone, Debug)]
pub struct ExposureSurvey {
    grid: Grid,
    course: Course,
}

impl ExposureSurvey {
    /// A survey of frames of `shape`.
    #[must_use]
    pub fn new(shape: Shape) -> Self {
        let grid = Grid::new(shape);
        Self { grid, course: Course::new(grid, Times::Ignored) }
    }

    /// Takes the next frame. One whose planes are not of the survey's shape gets no multiplier.
    pub fn push(&mut self, frame: &Frame) {
        let fits = frame.amplitude.shape() == self.grid.shape() && frame.check_shapes().is_ok();
        if fits { self.course.push(Look::of_frame(self.grid, frame)) } else { self.course.skip() }
    }

    /// The multipliers; `None` where too little stands still for most frames to be compared.
    #[must_use]
    pub fn finish(&self) -> Option<RelativeExposure> {
        let ln_factors = self.course.ln_factors();
        let multiplier =
            |ln_factor: &Option<f64>| ln_factor.map_or(f32::NAN, |ln_factor| (-ln_factor).exp() as f32);
        let multipliers: Arc<[f32]> = ln_factors.iter().map(multiplier).collect();
        let compared = ln_factors.iter().flatten().count();
        let enough = compared > 1 && compared as f64 >= LEAST_SHARE * ln_factors.len() as f64;
        enough.then_some(RelativeExposure { multipliers })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::Plane;

    const SHAPE: Shape = Shape::new(48, 64);

    /// A wall with a pattern; `gain` times as bright, and `moved_m` farther away.
    fn frame(gain: f32, moved_m: f32) -> Frame {
        let mut frame = Frame::new(SHAPE);
        let pattern = |row: usize, column: usize| 200.0 + 100.0 * ((row / 6 + column / 8) % 3) as f32;
        frame.amplitude = Plane::from_fn(SHAPE, |row, column| gain * pattern(row, column));
        frame.distance_m = Some(Plane::from_fn(SHAPE, |_, column| 1.0 + moved_m + 0.01 * column as f32));
        frame.flag_amplitude(None);
        frame
    }

    #[test]
    fn multipliers_undo_the_gains_of_a_still_scene_up_to_a_constant() {
        let mut survey = ExposureSurvey::new(SHAPE);
        let gains = [1.0, 2.0, 0.5, 1.0, 3.0];
        gains.iter().for_each(|&gain| survey.push(&frame(gain, 0.0)));
        let found = survey.finish().unwrap();
        for (index, gain) in gains.into_iter().enumerate() {
            // f32 and logarithms: a few roundings of 1e-7.
            assert!((found.multiplier(index) * gain - 1.0).abs() < 1e-5, "{index}");
        }
        assert_eq!((found.frames(), found.multiplier(5).is_nan()), ([5, 0], true));
        assert!((found.range()[1] - 3.0).abs() < 1e-4 && (found.range()[0] - 0.5).abs() < 1e-4);
    }

    #[test]
    fn nothing_is_told_of_scenes_that_move() {
        let mut survey = ExposureSurvey::new(SHAPE);
        (0..8).for_each(|index| survey.push(&frame(1.0, 0.2 * index as f32)));
        assert_eq!(survey.finish(), None);
    }
}
