//! Progress, remarks and cancellation: how a caller follows the work on a recording.

use std::fmt;

use crate::error::PipelineError;
use crate::remark::Remark;

/// The kinds of work whose progress is reported.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Work {
    /// Standardizing the frames of a recording.
    Standardizing,
    /// Reading the integration times of a recording.
    ReadingTimes,
    /// Estimating the noise of the amplitude from a recording.
    EstimatingNoise,
    /// Estimating the ambient light of a recording.
    EstimatingAmbientLight,
    /// Comparing all frames of a recording by what stands still.
    ComparingFrames,
    /// Evaluating a recording before and after standardization.
    Evaluating,
    /// Diagnosing a recording.
    Diagnosing,
    /// Measuring an exposure sweep.
    ExposureSweep,
    /// Measuring a distance sweep.
    DistanceSweep,
    /// Measuring a target.
    Target,
    /// Finding out how the camera moved in a scene.
    SceneMotion,
    /// Measuring a scene.
    Scene,
    /// Simulating a recording.
    Simulating,
}

impl fmt::Display for Work {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Standardizing => "standardizing",
            Self::ReadingTimes => "reading times",
            Self::EstimatingNoise => "estimating the noise",
            Self::EstimatingAmbientLight => "estimating the ambient light",
            Self::ComparingFrames => "comparing frames",
            Self::Evaluating => "evaluating",
            Self::Diagnosing => "diagnosing",
            Self::ExposureSweep => "exposure sweep",
            Self::DistanceSweep => "distance sweep",
            Self::Target => "target",
            Self::SceneMotion => "scene, first look",
            Self::Scene => "scene",
            Self::Simulating => "simulating",
        })
    }
}

/// Receives progress and remarks while the pipeline works, and may cancel it. The default of every method does
/// nothing.
///
/// The methods are called on the thread that called the pipeline.
pub trait Observer {
    /// Receives the progress: `done` frames of `total` are done. The total is `None` where the source does not know
    /// its length. Each pass begins with 0 frames done and, unless it fails, ends with all frames of `Some(total)`.
    fn progress(&self, work: Work, done: usize, total: Option<usize>) {
        let _ = (work, done, total);
    }

    /// Returns true to cancel the work. It is called between frames; the work then ends with
    /// [`PipelineError::Interrupted`], and no output is left behind.
    fn cancelled(&self) -> bool {
        false
    }

    /// Receives something that the user should know and that is in no result.
    fn remark(&self, remark: Remark) {
        let _ = remark;
    }
}

/// Ignores everything and never cancels.
#[derive(Clone, Copy, Debug, Default)]
pub struct Unobserved;

impl Observer for Unobserved {}

/// One pass over frames, as the observer sees it.
pub(crate) struct Progress<'a> {
    observer: &'a dyn Observer,
    work: Work,
    done: usize,
    total: Option<usize>,
}

impl<'a> Progress<'a> {
    /// Begins a pass.
    pub(crate) fn start(observer: &'a dyn Observer, work: Work, total: Option<usize>) -> Self {
        observer.progress(work, 0, total);
        Self { observer, work, done: 0, total }
    }

    /// Fails once the observer has cancelled.
    pub(crate) fn check(&self) -> Result<(), PipelineError> {
        if self.observer.cancelled() { Err(PipelineError::Interrupted) } else { Ok(()) }
    }

    /// One frame more is done.
    pub(crate) fn step(&mut self) {
        self.done += 1;
        self.observer.progress(self.work, self.done, self.total);
    }

    /// Ends the pass, at whatever length the source turned out to have.
    pub(crate) fn finish(self) {
        if self.total != Some(self.done) {
            self.observer.progress(self.work, self.done, Some(self.done));
        }
    }
}
