//! Frames are taken one by one, by a meter for each figure.

use super::evaluation::Evaluation;
use super::fraction::fraction;
use super::frame_to_frame::FrameToFrameMeter;
use super::input::{EvaluationFrame, Times};
use super::noise::NoiseMeter;
use super::outcome::{Outcome, Unavailable};
use super::pixel_cv::{PixelCv, PixelRuns};
use super::reference::ReferenceComparison;
use super::runs::TimesSeen;
use super::settings::EvaluationSettings;
use super::sigma::CoverageMeter;
use super::slope::SlopeSample;
use crate::frame::{Plane, Shape, ShapeError};

/// Takes frames one by one and comes to an [`Evaluation`]. Memory does not grow with the number of frames.
#[derive(Clone, Debug)]
pub struct Evaluator {
    shape: Shape,
    pub(super) settings: EvaluationSettings,
    usable: Vec<f32>,
    frames: u64,
    valid_values: u64,
    times: TimesSeen,
    pixel_runs: PixelRuns,
    frame_to_frame: FrameToFrameMeter,
    noise: NoiseMeter,
    coverage: Option<CoverageMeter>,
    slope: SlopeSample,
    reference: Option<ReferenceComparison>,
}

impl Evaluator {
    /// An evaluator of frames of `shape`.
    #[must_use]
    pub fn new(shape: Shape, settings: EvaluationSettings) -> Self {
        let pixels = shape.pixels();
        Self {
            shape,
            usable: vec![f32::NAN; pixels],
            frames: 0,
            valid_values: 0,
            times: TimesSeen::new(),
            pixel_runs: PixelRuns::new(pixels, settings.same_time_ratio),
            frame_to_frame: FrameToFrameMeter::new(shape),
            noise: NoiseMeter::new(shape, settings.same_time_ratio),
            coverage: None,
            slope: SlopeSample::new(settings.sample_capacity()),
            reference: None,
            settings,
        }
    }

    /// Gives the frame of the reference exposure, to be called before the first [`Self::push`]: frames pushed
    /// earlier are not compared with it. It is pushed with the others in its turn too. A frame without one known
    /// integration time is no reference; the figures that need one then say so.
    ///
    /// # Errors
    /// [`ShapeError::Mismatch`] when a plane is not of the evaluator's shape.
    pub fn set_reference(&mut self, frame: &EvaluationFrame<'_>) -> Result<(), ShapeError> {
        frame.check_shapes(self.shape)?;
        frame.usable_into(&mut self.usable);
        let time_us = Times::of(frame.integration_time_us).of_frame();
        self.reference = time_us.map(|time_us| ReferenceComparison::new(&self.usable, time_us));
        Ok(())
    }

    /// Takes in the next frame of the recording, in its order.
    ///
    /// # Errors
    /// [`ShapeError::Mismatch`] when a plane is not of the evaluator's shape; the frame then does not count.
    pub fn push(&mut self, frame: &EvaluationFrame<'_>) -> Result<(), ShapeError> {
        frame.check_shapes(self.shape)?;
        self.valid_values += frame.usable_into(&mut self.usable) as u64;
        self.frames += 1;
        let times = Times::of(frame.integration_time_us);
        self.times.push(&self.usable, times);
        self.pixel_runs.push(&self.usable, times);
        self.frame_to_frame.push(&self.usable, frame);
        self.noise.push(&self.usable, times);
        self.slope.push(&self.usable, frame, times);
        if let Some(sigma) = frame.sigma {
            let new = || CoverageMeter::new(self.shape.pixels(), self.settings.same_time_ratio);
            self.coverage.get_or_insert_with(new).push(&self.usable, sigma, frame.flags, times);
        }
        if let (Some(reference), Some(time_us)) = (&mut self.reference, times.of_frame()) {
            reference.push(&self.usable, time_us, self.settings.same_time_ratio);
        }
        Ok(())
    }

    /// The figures of all frames pushed. The strata are those of the evaluator's own signal-to-noise ratio.
    #[must_use]
    pub fn finish(&self) -> Evaluation {
        self.finish_stratified(&self.signal_to_noise())
    }

    /// Signal-to-noise ratio of each pixel in a single frame: mean over integration times / pooled σ between
    /// consecutive frames of one time (at least four pairs); infinite where σ is 0, NaN where it is unknown.
    ///
    /// # Errors
    /// [`Unavailable::NoRepeatedFrames`] when it is known nowhere.
    pub fn signal_to_noise(&self) -> Outcome<Plane<f32>> {
        self.noise.signal_to_noise(self.pixel_runs.means())
    }

    pub(super) fn finish_stratified(&self, snr: &Outcome<Plane<f32>>) -> Evaluation {
        let pixel_cv = self.pixel_cv();
        let strata = |snr: &Plane<f32>| self.pixel_runs.strata(snr, &self.settings.snr_edges);
        let compared = self.compared();
        Evaluation {
            frames: self.frames,
            pixels_per_frame: self.shape.pixels(),
            valid_fraction: self.require_frames().ok().map(|()| fraction(self.valid_values, self.values())),
            reference_time_us: self.reference.as_ref().map(|reference| f64::from(reference.time_us())),
            pixel_cv,
            pixel_cv_by_snr: pixel_cv.and_then(|_| snr.as_ref().map(strata).map_err(|reason| *reason)),
            image_cv: compared.and_then(ReferenceComparison::image_cv),
            frame_to_frame: self.require_valid().and_then(|()| self.frame_to_frame.finish()),
            distance_slope: self.require_valid().and_then(|()| self.slope.finish(&self.settings)),
            threshold_iou: compared.and_then(ReferenceComparison::threshold_iou),
            otsu_shift: compared.and_then(ReferenceComparison::otsu_shift),
            histogram_distance: compared.and_then(ReferenceComparison::histogram_distance),
            noise: self.require_valid().and_then(|()| self.noise.finish()),
            sigma_coverage: self.require_valid().and_then(|()| self.coverage()?.finish(self.values())),
            sigma_coverage_by_snr: self.coverage().and_then(|coverage| {
                let snr = snr.as_ref().map_err(|reason| *reason)?;
                Ok(coverage.strata(snr, &self.settings.snr_edges))
            }),
        }
    }

    fn pixel_cv(&self) -> Outcome<PixelCv> {
        self.require_valid()?;
        self.times.require_variation(self.settings.same_time_ratio)?;
        self.pixel_runs.finish(self.frames)
    }

    fn compared(&self) -> Outcome<&ReferenceComparison> {
        self.require_valid()?;
        self.times.require_variation_of_frames(self.settings.same_time_ratio)?;
        self.reference.as_ref().ok_or(Unavailable::NoReference)
    }

    fn coverage(&self) -> Outcome<&CoverageMeter> {
        self.coverage.as_ref().ok_or(Unavailable::NoSigma)
    }

    fn require_frames(&self) -> Outcome<()> {
        if self.values() > 0 { Ok(()) } else { Err(Unavailable::NoFrames) }
    }

    fn require_valid(&self) -> Outcome<()> {
        self.require_frames()?;
        if self.valid_values > 0 { Ok(()) } else { Err(Unavailable::NoValidPixels) }
    }

    fn values(&self) -> u64 {
        self.frames * self.shape.pixels() as u64
    }
}
