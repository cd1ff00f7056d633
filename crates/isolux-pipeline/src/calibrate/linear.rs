//! Makes frames linear before anything is fitted to them, where response and recording allow it.

use isolux::calibrate::MeasureError;
use isolux::standardize::FrameLineariser;
use isolux::terms::Response;
use isolux::{Channels, Frame};

use crate::source::SourceFacts;

/// Makes the frames of one recording linear; holds the last linear frame.
pub(super) struct Linear(Option<(FrameLineariser, Frame)>);

impl Linear {
    pub(super) fn new(facts: &SourceFacts, response: Option<&Response>) -> Self {
        let lineariser = response.and_then(|response| FrameLineariser::new(response, facts.available));
        Self(lineariser.map(|lineariser| (lineariser, Frame::new(facts.shape))))
    }

    /// Whether frames are made linear at all.
    pub(super) fn is_possible(&self) -> bool {
        self.0.is_some()
    }

    /// The channels that it reads besides amplitude and distance.
    pub(super) fn channels(&self) -> Channels {
        self.0.as_ref().map_or(Channels::empty(), |(lineariser, _)| lineariser.channels())
    }

    /// `frame`, made linear where that is possible.
    pub(super) fn frame<'a>(&'a mut self, frame: &'a Frame) -> Result<&'a Frame, MeasureError> {
        let Some((lineariser, linear)) = &mut self.0 else { return Ok(frame) };
        linear.clone_from(frame);
        lineariser.linearise(linear)?;
        Ok(linear)
    }
}
