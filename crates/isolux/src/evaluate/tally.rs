//! One figure a frame: mean, extremes, and the pixels behind it.

use super::fraction::fraction;

/// Running mean and extremes over frames, with the pixels that entered.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Tally {
    frames: u32,
    sum: f64,
    minimum: f64,
    maximum: f64,
    entered: u64,
    pixels: u64,
}

/// What a [`Tally`] of at least one frame comes to.
pub(super) struct Summary {
    pub(super) mean: f64,
    pub(super) minimum: f64,
    pub(super) maximum: f64,
    pub(super) frames: u32,
    pub(super) valid_fraction: f64,
}

impl Tally {
    /// Takes in the figure of a frame, which rests on `entered` of its `pixels`.
    pub(super) fn push(&mut self, figure: f64, entered: usize, pixels: usize) {
        let first = self.frames == 0;
        self.minimum = if first { figure } else { self.minimum.min(figure) };
        self.maximum = if first { figure } else { self.maximum.max(figure) };
        self.frames = self.frames.saturating_add(1);
        self.sum += figure;
        self.entered += entered as u64;
        self.pixels += pixels as u64;
    }

    pub(super) fn summary(&self) -> Option<Summary> {
        (self.frames > 0).then(|| Summary {
            mean: self.sum / f64::from(self.frames),
            minimum: self.minimum,
            maximum: self.maximum,
            frames: self.frames,
            valid_fraction: fraction(self.entered, self.pixels),
        })
    }
}
