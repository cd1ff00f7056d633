//! Frames made linear before something is fitted to them.

use super::StandardizeError;
use super::linearise::{Linearised, Lineariser, Repaired};
use crate::frame::{Channels, Frame};
use crate::terms::response::Response;

/// Undoes each pixel's compression by its measured fill, as the response step does: what is fitted after it (a law over
/// distance, a profile) then describes the light, not the full well.
#[derive(Clone, Debug)]
pub struct FrameLineariser {
    lineariser: Lineariser,
    linearised: Linearised,
}

impl FrameLineariser {
    /// By the raw bins or the intensity, whichever of them the response covers and the recording has, in this order.
    /// `None` where neither is there: only a measured fill holds for any scene.
    #[must_use]
    pub fn new(response: &Response, available: Channels) -> Option<Self> {
        let has = |channel| available.contains(channel);
        let bins = response.phase_samples.as_ref().filter(|_| has(Channels::PHASE_SAMPLES));
        let intensity = response.intensity.as_ref().filter(|_| has(Channels::INTENSITY));
        let lineariser = match (bins, intensity) {
            (Some(tier), _) => Lineariser::PhaseSamples(tier.planned()),
            (None, Some(tier)) => Lineariser::Intensity(tier.planned()),
            (None, None) => return None,
        };
        Some(Self { lineariser, linearised: Linearised::new() })
    }

    /// The channels that it reads besides amplitude and distance.
    #[must_use]
    pub fn channels(&self) -> Channels {
        self.lineariser.channels()
    }

    /// Makes `frame` linear in place: amplitude in the DN of a pixel without a full well, distance repaired where the
    /// raw bins tell it. Pixels whose linear value nothing tells become SATURATED and INVALID.
    ///
    /// # Errors
    /// [`StandardizeError`] when the frame lacks the channel, or its planes differ in shape.
    pub fn linearise(&mut self, frame: &mut Frame) -> Result<(), StandardizeError> {
        frame.check_shapes()?;
        let mut flags = std::mem::replace(
            &mut frame.flags,
            crate::Plane::filled(crate::Shape::new(0, 0), Default::default()),
        );
        let repaired = self.linearised.fill(&self.lineariser, frame, flags.values_mut());
        frame.flags = flags;
        let repaired = repaired?;
        frame.amplitude.values_mut().copy_from_slice(self.linearised.amplitude());
        if let (Repaired::AmplitudeAndDistance, Some(distance_m)) = (repaired, &mut frame.distance_m) {
            distance_m.values_mut().copy_from_slice(self.linearised.distance_m().values());
        }
        Ok(())
    }
}
