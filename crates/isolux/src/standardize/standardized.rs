//! A standardized frame, and counts of what happened to its pixels.

use super::kernel::{BLOCK, TALLIES, tally};
use crate::frame::{PixelFlags, Plane, Shape};

/// A standardized frame: planes of the frame's height × width. Reuse one for a whole recording.
#[derive(Clone, Debug, PartialEq)]
pub struct Standardized {
    /// Amplitude expected at the reference time and distance, DN; NaN exactly where INVALID is flagged.
    pub amplitude: Plane<f32>,
    /// The frame's flags, and those that the steps added.
    pub flags: Plane<PixelFlags>,
    /// Predicted standard deviation of each amplitude before highlights were limited, DN; NaN where INVALID is
    /// flagged or the noise is unknown. `None` where the plan predicts none.
    pub sigma: Option<Plane<f32>>,
    /// Counts over the frame.
    pub summary: FrameSummary,
}

/// Counts over the pixels of one frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FrameSummary {
    /// Pixels with a standardized value.
    pub valid: usize,
    /// Those of them that no term was extrapolated to.
    pub within_range: usize,
    /// All pixels.
    pub pixels: usize,
    /// Measured pixels whose integration time is unknown or above the table's range; they become INVALID.
    pub time_refused: usize,
    /// Measured pixels whose integration time is below the table's range; extrapolated as 1/t and flagged.
    pub time_extrapolated: usize,
    /// Pixels whose distance is outside the fitted range; extrapolated as d² and flagged.
    pub distance_extrapolated: usize,
    /// Pixels outside the support of the profile, or steeper than the angle term was fitted on; extrapolated and
    /// flagged.
    pub illumination_extrapolated: usize,
    /// Pixels limited as specular.
    pub specular: usize,
    /// The value they were limited to, DN; `None` when the rule found no cutoff or there is no such step.
    pub specular_cutoff: Option<f32>,
}

impl Standardized {
    /// An empty result for frames of `shape`: NaN, nothing flagged, no σ.
    #[must_use]
    pub fn new(shape: Shape) -> Self {
        Self {
            amplitude: Plane::filled(shape, f32::NAN),
            flags: Plane::filled(shape, PixelFlags::empty()),
            sigma: None,
            summary: FrameSummary::default(),
        }
    }

    /// Bytes that its planes have allocated.
    #[must_use]
    pub fn bytes(&self) -> usize {
        self.amplitude.bytes() + self.flags.bytes() + self.sigma.as_ref().map_or(0, Plane::bytes)
    }

    /// Takes the shape of a frame; does not allocate when it is unchanged.
    pub(super) fn reshape(&mut self, shape: Shape, with_sigma: bool) {
        self.amplitude.reshape(shape, f32::NAN);
        self.flags.reshape(shape, PixelFlags::empty());
        if with_sigma {
            let sigma = self.sigma.get_or_insert_with(|| Plane::filled(shape, f32::NAN));
            sigma.reshape(shape, f32::NAN);
        } else {
            self.sigma = None;
        }
    }
}

impl FrameSummary {
    /// Counts the flags of a frame. The counts of the time step and the cutoff are set elsewhere.
    pub(super) fn of(flags: &[PixelFlags]) -> Self {
        let mut totals = [0; TALLIES.len()];
        flags.chunks(BLOCK).for_each(|block| tally(block, &mut totals));
        let [invalid, distance_extrapolated, specular, illumination_extrapolated, within_range] = totals;
        Self {
            valid: flags.len() - invalid,
            within_range,
            pixels: flags.len(),
            distance_extrapolated,
            illumination_extrapolated,
            specular,
            ..Self::default()
        }
    }
}
