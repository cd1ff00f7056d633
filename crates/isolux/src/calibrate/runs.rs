//! Runs of equal integration time within a recording, and the settling frames at their start.

/// Follows the integration time from frame to frame.
#[derive(Clone, Debug)]
pub(super) struct Runs {
    skip_frames: usize,
    time_us: Option<f64>,
    frames_in_run: usize,
    pub(super) decreased: bool,
}

/// The place of a frame in its run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Place {
    /// Among the frames to be skipped.
    Settling,
    /// The first frame that counts.
    First,
    /// A later frame that counts.
    Later,
}

impl Runs {
    pub(super) fn new(skip_frames: usize) -> Self {
        Self { skip_frames, time_us: None, frames_in_run: 0, decreased: false }
    }

    /// Takes the next frame's time (µs; NaN where it is unknown).
    pub(super) fn push(&mut self, time_us: f64) -> Place {
        let unknown_too = |last: f64| last.is_nan() && time_us.is_nan();
        if !self.time_us.is_some_and(|last| last == time_us || unknown_too(last)) {
            self.decreased |= self.time_us.is_some_and(|last| time_us < last);
            self.time_us = Some(time_us);
            self.frames_in_run = 0;
        }
        self.frames_in_run += 1;
        match self.frames_in_run.checked_sub(self.skip_frames) {
            None | Some(0) => Place::Settling,
            Some(1) => Place::First,
            Some(_) => Place::Later,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_frames_after_each_change_settle() {
        let mut runs = Runs::new(2);
        let places: Vec<_> = [1.0, 1.0, 1.0, 1.0, 2.0, 2.0, 2.0].map(|t| runs.push(t)).into();
        use Place::{First, Later, Settling};
        assert_eq!(places, [Settling, Settling, First, Later, Settling, Settling, First]);
        assert!(!runs.decreased);
        runs.push(1.0);
        assert!(runs.decreased);
    }
}
