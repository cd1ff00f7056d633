//! What every sweep keeps about its frames: their number, which of them are settling, and which times are left out.

use super::runs::{Place, Runs};
use super::{CalibrateSettings, MeasureError};
use crate::frame::{Frame, IntegrationTime};
use crate::terms::Source;

/// Counts the frames of one recording.
#[derive(Clone, Debug)]
pub(super) struct SweepFrames {
    pub(super) recording: String,
    pub(super) settings: CalibrateSettings,
    runs: Runs,
    count: usize,
}

impl SweepFrames {
    /// `recording` is the name of the recording in errors and in the calibration.
    pub(super) fn new(recording: impl Into<String>, settings: &CalibrateSettings) -> Self {
        let runs = Runs::new(settings.skip_frames);
        Self { recording: recording.into(), settings: settings.clone(), runs, count: 0 }
    }

    /// The number of the next frame, from 0.
    ///
    /// # Errors
    /// [`MeasureError::Shape`] when its planes do not fit together.
    pub(super) fn next(&mut self, frame: &Frame) -> Result<usize, MeasureError> {
        let number = self.count;
        self.count += 1;
        frame.check_shapes().map_err(|source| MeasureError::Shape { frame: number, source })?;
        Ok(number)
    }

    /// The place of a frame among those of its time (µs; NaN where it is unknown). `None` where it does not count:
    /// the camera is settling, or the time is left out.
    pub(super) fn place(&mut self, time_us: f64) -> Option<Place> {
        let place = self.runs.push(time_us);
        Some(place).filter(|place| *place != Place::Settling && !self.settings.excludes(time_us))
    }

    /// True when a time was shorter than the one before.
    pub(super) fn times_decreased(&self) -> bool {
        self.runs.decreased
    }

    /// The recording as the calibration names it.
    pub(super) fn source(&self, frames_used: usize) -> Source {
        let frames_left_out = self.count - frames_used;
        Source { recording: self.recording.clone(), frames_used, frames_left_out }
    }
}

/// The one time of a frame, µs; else a description of what was found.
pub(super) fn single_time(time: &IntegrationTime) -> Result<f64, &'static str> {
    match time {
        IntegrationTime::PerFrame(time) => Ok(*time),
        IntegrationTime::Unknown => Err("unknown"),
        IntegrationTime::PerPixel(_) => Err("a map with a time for each pixel"),
    }
}

/// The one time of a frame, µs, NaN where it is unknown; else a description of what was found.
pub(super) fn single_or_unknown_time(time: &IntegrationTime) -> Result<f64, &'static str> {
    match time {
        IntegrationTime::Unknown => Ok(f64::NAN),
        known => single_time(known),
    }
}
