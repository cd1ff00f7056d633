//! Counts over the pixels of a recording.

use isolux::standardize::FrameSummary;
use serde::Serialize;

/// Totals over all frames that were handed out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Summary {
    /// Frames.
    pub frames: usize,
    /// All their pixels.
    pub pixels: usize,
    /// Pixels with a value.
    pub valid: usize,
    /// Those of them that no term was extrapolated to.
    pub within_range: usize,
    /// Measured pixels whose integration time is unknown or above the calibrated range; they become INVALID.
    pub time_refused: usize,
    /// Measured pixels whose integration time is outside the calibrated range; extrapolated as 1/t and flagged.
    pub time_extrapolated: usize,
    /// Pixels outside the calibrated distances; extrapolated as d² and flagged.
    pub distance_extrapolated: usize,
    /// Pixels outside the profile's support, or steeper than the angle term was fitted on; extrapolated and
    /// flagged.
    pub illumination_extrapolated: usize,
    /// Pixels limited as specular.
    pub specular: usize,
    /// Frames in which the specular rule found no cutoff, or there was no such step.
    pub frames_without_cutoff: usize,
}

impl Summary {
    pub(super) fn add(&mut self, frame: FrameSummary) {
        self.frames += 1;
        self.pixels += frame.pixels;
        self.valid += frame.valid;
        self.within_range += frame.within_range;
        self.time_refused += frame.time_refused;
        self.time_extrapolated += frame.time_extrapolated;
        self.distance_extrapolated += frame.distance_extrapolated;
        self.illumination_extrapolated += frame.illumination_extrapolated;
        self.specular += frame.specular;
        self.frames_without_cutoff += usize::from(frame.specular_cutoff.is_none());
    }
}
