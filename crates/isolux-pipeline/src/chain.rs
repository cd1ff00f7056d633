//! A planned chain going through a recording's frames in order, with the history that it may need.

use isolux::denoise::TemporalMean;
use isolux::standardize::{FrameSummary, StandardizeError};
use isolux::{Channels, Frame, Plane, Shape, Standardized, Standardizer};

use crate::error::PipelineError;
use crate::frames::read_present;
use crate::source::FrameSource;

/// The distances that a frame is to be scaled by, and the share of their variance that is left, where they depend on
/// the frames before it; empty otherwise.
#[derive(Clone, Debug)]
pub(crate) struct Smoothed(Option<[Plane<f32>; 2]>);

/// What happens to the frames in order. A frame's result depends on it and the few before it alone.
#[derive(Debug)]
pub(crate) struct Chain<'a> {
    standardizer: &'a Standardizer,
    history: Option<TemporalMean>,
}

impl<'a> Chain<'a> {
    pub(crate) fn new(standardizer: &'a Standardizer) -> Self {
        Self { standardizer, history: standardizer.history() }
    }

    /// Memory for one frame at work.
    pub(crate) fn smoothed(&self) -> Smoothed {
        let plane = || Plane::filled(Shape::new(0, 0), f32::NAN);
        Smoothed(self.history.as_ref().map(|_| [plane(), plane()]))
    }

    /// Bytes per pixel of [`Self::smoothed`] and of the history.
    pub(crate) fn bytes_per_pixel(&self) -> (usize, usize) {
        self.history.as_ref().map_or((0, 0), |_| (8, 8 * TemporalMean::FRAMES))
    }

    /// True where results have a predicted standard deviation.
    pub(crate) fn predicts_sigma(&self) -> bool {
        self.standardizer.predicts_sigma()
    }

    /// Takes the next frame in order; afterwards [`apply`] may work on it in any order and thread.
    pub(crate) fn take(&mut self, frame: &Frame, out: &mut Smoothed) -> Result<(), StandardizeError> {
        match (&mut self.history, &mut out.0) {
            (Some(history), Some([distance_m, left])) => {
                history.push(frame, distance_m)?;
                if self.standardizer.predicts_sigma() {
                    history.variance_left(left);
                }
                Ok(())
            }
            _ => Ok(()),
        }
    }

    /// Both at once.
    pub(crate) fn standardize(
        &mut self,
        frame: &Frame,
        smoothed: &mut Smoothed,
        out: &mut Standardized,
    ) -> Result<FrameSummary, StandardizeError> {
        self.take(frame, smoothed)?;
        apply(self.standardizer, frame, smoothed, out)
    }

    /// Reads frame `index` out of its turn, with those before it that it depends on.
    pub(crate) fn read_alone(
        &mut self,
        source: &mut dyn FrameSource,
        index: usize,
        wanted: Channels,
        frame: &mut Frame,
    ) -> Result<(), PipelineError> {
        if let Some(history) = &mut self.history {
            history.reset();
            let mut unused = Plane::filled(Shape::new(0, 0), f32::NAN);
            for earlier in (index + 1).saturating_sub(TemporalMean::FRAMES)..index {
                read_present(source, earlier, wanted | self.standardizer.needed(), frame)?;
                history
                    .push(frame, &mut unused)
                    .map_err(|error| PipelineError::frame(&source.facts().name, earlier)(error.into()))?;
            }
        }
        read_present(source, index, wanted, frame)
    }

    /// Begins another pass.
    pub(crate) fn restart(&mut self) {
        if let Some(history) = &mut self.history {
            history.reset();
        }
    }
}

/// Standardizes a frame that the chain has taken.
pub(crate) fn apply(
    standardizer: &Standardizer,
    frame: &Frame,
    smoothed: &Smoothed,
    out: &mut Standardized,
) -> Result<FrameSummary, StandardizeError> {
    match &smoothed.0 {
        Some([distance_m, left]) if standardizer.predicts_sigma() => {
            standardizer.apply_denoised(frame, distance_m, left, out)
        }
        Some([distance_m, _]) => standardizer.apply_at(frame, distance_m, out),
        None => standardizer.apply(frame, out),
    }
}
