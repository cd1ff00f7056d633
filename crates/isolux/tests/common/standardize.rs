//! The one place where the tests call a [`Standardizer`].

use isolux::standardize::{FrameSummary, StandardizeError};
use isolux::{Frame, PixelFlags, Plane, Shape, Standardized, Standardizer};

/// A standardized frame with its counts.
#[derive(Clone, Debug)]
pub struct Finished {
    pub amplitude: Plane<f32>,
    pub flags: Plane<PixelFlags>,
    pub summary: FrameSummary,
}

/// Memory that is used for one frame after the other.
pub struct Memory(Standardized);

impl Memory {
    pub fn new(shape: Shape) -> Self {
        Self(Standardized::new(shape))
    }

    pub fn standardize(
        &mut self,
        standardizer: &Standardizer,
        frame: &Frame,
    ) -> Result<Finished, StandardizeError> {
        let summary = standardizer.apply(frame, &mut self.0)?;
        Ok(Finished { amplitude: self.0.amplitude.clone(), flags: self.0.flags.clone(), summary })
    }
}

/// One frame, in memory of its own.
pub fn standardize(standardizer: &Standardizer, frame: &Frame) -> Finished {
    try_standardize(standardizer, frame).unwrap()
}

/// The same, where it may be refused.
pub fn try_standardize(standardizer: &Standardizer, frame: &Frame) -> Result<Finished, StandardizeError> {
    Memory::new(frame.shape()).standardize(standardizer, frame)
}
