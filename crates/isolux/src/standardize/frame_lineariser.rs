//! Corrects whole frames for saturation before something is fitted to them.

use super::error::StandardizeError;
use super::steps::response::{Corrected, Fill, Repaired, SaturationCorrection};
use crate::frame::{Channels, Frame, PixelFlags, Plane, Shape};
use crate::terms::response::Response;

/// Corrects the saturation of each pixel by its measured fill, as the response step does. What is fitted to such
/// frames (a law over distance, a profile) then describes the light and not the saturation.
#[derive(Clone, Debug)]
pub struct FrameLineariser {
    correction: SaturationCorrection,
    corrected: Corrected,
}

impl FrameLineariser {
    /// Uses the raw bins, else the intensity, if the response was fitted for that channel and the recording has it.
    /// `None` when neither is available: only a measured fill is valid for any scene.
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

    /// The channels that are read besides amplitude and distance.
    #[must_use]
    pub fn channels(&self) -> Channels {
        self.correction.channels()
    }

    /// Makes `frame` linear in place: corrects the amplitude for saturation, and with the raw bins also the
    /// distance. Pixels that cannot be corrected become SATURATED and INVALID.
    ///
    /// # Errors
    /// [`StandardizeError`] when the frame lacks the channel, or its planes differ in shape.
    pub fn linearise(&mut self, frame: &mut Frame) -> Result<(), StandardizeError> {
        frame.check_shapes()?;
        let none = Plane::filled(Shape::new(0, 0), PixelFlags::empty());
        let mut flags = std::mem::replace(&mut frame.flags, none);
        let repaired = self.corrected.fill(&self.correction, frame, Fill::default(), flags.values_mut());
        frame.flags = flags;
        let repaired = repaired?;
        frame.amplitude.values_mut().copy_from_slice(self.corrected.amplitude());
        if let (Repaired::AmplitudeAndDistance, Some(distance_m)) = (repaired, &mut frame.distance_m) {
            distance_m.values_mut().copy_from_slice(self.corrected.distance_m().values());
        }
        Ok(())
    }
}
