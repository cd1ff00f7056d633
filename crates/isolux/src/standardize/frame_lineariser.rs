//! Whole frames corrected for saturation before something is fitted to them.

use super::error::StandardizeError;
use super::steps::response::{Corrected, Repaired, SaturationCorrection};
use crate::frame::PixelFlags;
use crate::frame::{Channels, Frame};
use crate::frame::{Plane, Shape};
use crate::terms::response::Response;

/// Undoes each pixel's compression by its measured fill, as the response step does: what is fitted after it (a law over
/// distance, a profile) then describes the light, not the full well.
#[derive(Clone, Debug)]
pub struct FrameLineariser {
    correction: SaturationCorrection,
    corrected: Corrected,
}

impl FrameLineariser {
    /// By the raw bins or the intensity, whichever of them the response covers and the recording has, in this order.
    /// `None` where neither is there: only a measured fill holds for any scene.
    #[must_use]
    pub fn new(response: &Response, available: Channels) -> Option<Self> {
        let has = |channel| available.contains(channel);
        let bins = response.phase_samples.as_ref().filter(|_| has(Channels::PHASE_SAMPLES));
        let intensity = response.intensity.as_ref().filter(|_| has(Channels::INTENSITY));
        let correction = match (bins, intensity) {
            (Some(tier), _) => SaturationCorrection::PhaseSamples(tier.planned()),
            (None, Some(tier)) => SaturationCorrection::Intensity(tier.planned()),
            (None, None) => return None,
        };
        Some(Self { correction, corrected: Corrected::default() })
    }

    /// The channels that it reads besides amplitude and distance.
    #[must_use]
    pub fn channels(&self) -> Channels {
        self.correction.channels()
    }

    /// Makes `frame` linear in place: the amplitude is corrected for saturation, and so is the distance where the
    /// raw bins tell it. Pixels that nothing can correct become SATURATED and INVALID.
    ///
    /// # Errors
    /// [`StandardizeError`] when the frame lacks the channel, or its planes differ in shape.
    pub fn linearise(&mut self, frame: &mut Frame) -> Result<(), StandardizeError> {
        frame.check_shapes()?;
        let none = Plane::filled(Shape::new(0, 0), PixelFlags::empty());
        let mut flags = std::mem::replace(&mut frame.flags, none);
        let repaired = self.corrected.fill(&self.correction, frame, flags.values_mut());
        frame.flags = flags;
        let repaired = repaired?;
        frame.amplitude.values_mut().copy_from_slice(self.corrected.amplitude());
        if let (Repaired::AmplitudeAndDistance, Some(distance_m)) = (repaired, &mut frame.distance_m) {
            distance_m.values_mut().copy_from_slice(self.corrected.distance_m().values());
        }
        Ok(())
    }
}
