//! Each kind of recording, measured frame by frame.

use isolux::calibrate::{
    CalibrateSettings, DistanceSweep, ExposureCurve, ExposureSweep, MeasureError, MotionScout,
    ReferenceDecays, SceneObservations, SceneSweep, TargetSweep, TargetWindows,
};
use isolux::terms::Response;
use isolux::{Channels, Frame};

use super::linear::Linear;
use crate::error::PipelineError;
use crate::frames;
use crate::inspect;
use crate::observer::{Observer, Work};
use crate::source::FrameSource;

/// The channels that show the fill of a pixel.
const RESPONSE_CHANNELS: Channels = Channels::INTENSITY.union(Channels::PHASE_SAMPLES);
/// What the measurements of all kinds of recordings have in common.
const MEASURED_CHANNELS: Channels =
    Channels::AMPLITUDE.union(Channels::DISTANCE).union(Channels::INTEGRATION_TIME);

/// What all measurements of one calibration share.
pub(super) struct Measurer<'a> {
    pub(super) settings: &'a CalibrateSettings,
    pub(super) observer: &'a dyn Observer,
    /// The names of the recordings' cameras, in the order in which they were measured.
    pub(super) cameras: Vec<String>,
}

impl Measurer<'_> {
    pub(super) fn exposure_curve(
        &mut self,
        source: &mut dyn FrameSource,
    ) -> Result<ExposureCurve, PipelineError> {
        let mut sweep = ExposureSweep::new(self.introduce(source)?, self.settings);
        self.each(source, Work::ExposureSweep, RESPONSE_CHANNELS, |frame| sweep.push(frame))?;
        Ok(sweep.finish())
    }

    /// The decays as they were delivered, and linear where the response allows it.
    pub(super) fn reference_decays(
        &mut self,
        source: &mut dyn FrameSource,
        response: Option<&Response>,
    ) -> Result<(ReferenceDecays, Option<ReferenceDecays>), PipelineError> {
        let mut delivered = DistanceSweep::new(self.introduce(source)?, self.settings);
        let mut linear_sweep = delivered.clone();
        let mut linear = Linear::new(&source.facts(), response);
        self.each(source, Work::DistanceSweep, linear.channels(), |frame| {
            delivered.push(frame)?;
            if linear.is_possible() { linear_sweep.push(linear.frame(frame)?) } else { Ok(()) }
        })?;
        Ok((delivered.finish(), linear.is_possible().then(|| linear_sweep.finish())))
    }

    /// The windows, linear where the response allows it.
    pub(super) fn target_windows(
        &mut self,
        source: &mut dyn FrameSource,
        response: Option<&Response>,
    ) -> Result<TargetWindows, PipelineError> {
        let facts = source.facts();
        let mut sweep = TargetSweep::new(self.introduce(source)?, self.settings, facts.lens());
        let mut linear = Linear::new(&facts, response);
        if linear.is_possible() {
            sweep = sweep.of_linear_frames();
        }
        self.each(source, Work::Target, Channels::TARGET | linear.channels(), |frame| {
            sweep.push(linear.frame(frame)?)
        })?;
        Ok(sweep.finish())
    }

    /// Reads the frames once to find out where their poses come from, then measures them.
    pub(super) fn scene_observations(
        &mut self,
        source: &mut dyn FrameSource,
        response: Option<&Response>,
    ) -> Result<SceneObservations, PipelineError> {
        let (facts, name) = (source.facts(), self.introduce(source)?);
        let mut linear = Linear::new(&facts, response);
        // Without a response, a still scene may determine it.
        let besides = if linear.is_possible() { linear.channels() } else { RESPONSE_CHANNELS };
        let mut scout = MotionScout::default();
        self.each(source, Work::SceneMotion, Channels::POSE, |frame| {
            scout.push(frame);
            Ok(())
        })?;
        let mut sweep = SceneSweep::new(name, self.settings, facts.lens(), scout.verdict());
        self.each(source, Work::Scene, Channels::POSE | besides, |frame| sweep.push(linear.frame(frame)?))?;
        Ok(sweep.finish())
    }

    /// Notes the camera of a recording, what is to be said of its lens, and what contradicts its description; its name.
    fn introduce(&mut self, source: &mut dyn FrameSource) -> Result<String, PipelineError> {
        inspect::remark_on(source, self.observer)?;
        let facts = source.facts();
        facts.remark_on_lens(self.observer);
        self.cameras.extend(facts.info.camera);
        Ok(facts.name)
    }

    fn each(
        &self,
        source: &mut dyn FrameSource,
        work: Work,
        besides: Channels,
        mut push: impl FnMut(&Frame) -> Result<(), MeasureError>,
    ) -> Result<(), PipelineError> {
        let recording = source.facts().name;
        frames::for_each(source, MEASURED_CHANNELS | besides, work, self.observer, |_, frame| {
            push(frame).map_err(|cause| PipelineError::Measure { recording: recording.clone(), cause })
        })
    }
}
