//! A standardized frame, and what happened to it.

use super::kernel::{BLOCK, TALLIES, tally};
use crate::frame::PixelFlags;
use crate::frame::{Plane, Shape};

/// A standardized frame; reuse one for a whole recording.
#[derive(Clone, Debug, PartialEq)]
pub struct Standardized {
    /// Amplitude expected at the reference time and distance, DN; NaN exactly where INVALID is flagged.
    pub amplitude: Plane<f32>,
    /// The frame's flags, with those of the correction.
    pub flags: Plane<PixelFlags>,
    /// Predicted standard deviation of each amplitude before highlights were limited, DN; NaN where INVALID is
    /// flagged or the noise is unknown. `None` where the plan predicts none.
    pub sigma: Option<Plane<f32>>,
    /// Counts over the frame.
    pub summary: FrameSummary,
}

/// What happened to one frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FrameSummary {
    /// Pixels with a value.
    pub valid: usize,
    /// All pixels.
    pub pixels: usize,
    /// Measured pixels whose integration time is above the table's range, or unknown: refused.
    pub time_refused: usize,
    /// Measured pixels whose integration time is below the table: continued as 1/t and flagged.
    pub time_extrapolated: usize,
    /// Pixels whose distance is outside the fitted range: continued as d² and flagged.
    pub distance_extrapolated: usize,
    /// Pixels outside the support of the profile or steeper than the angle term has seen: continued and flagged.
    pub illumination_extrapolated: usize,
    /// Pixels limited as specular.
    pub specular: usize,
    /// The value they were limited to, DN; `None` when the rule found no cutoff or there is no such step.
    pub specular_cutoff: Option<f32>,
}

impl Standardized {
    /// Memory for frames of `shape`.
    #[must_use]
    pub fn new(shape: Shape) -> Self {
        Self {
            amplitude: Plane::filled(shape, f32::NAN),
            flags: Plane::filled(shape, PixelFlags::empty()),
            sigma: None,
            summary: FrameSummary::default(),
        }
    }

    /// Bytes that it holds.
    #[must_use]
    pub fn bytes(&self) -> usize {
        self.amplitude.bytes() + self.flags.bytes() + self.sigma.as_ref().map_or(0, Plane::bytes)
    }

    /// Follows a frame of another shape; does not allocate when the shape is unchanged.
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
    /// Counts the flags of a frame; the counts of the time step and the cutoff are not among them.
    pub(super) fn of(flags: &[PixelFlags]) -> Self {
        let mut totals = [0; TALLIES.len()];
        flags.chunks(BLOCK).for_each(|block| tally(block, &mut totals));
        let [invalid, distance_extrapolated, specular, illumination_extrapolated] = totals;
        Self {
            valid: flags.len() - invalid,
            pixels: flags.len(),
            distance_extrapolated,
            illumination_extrapolated,
            specular,
            ..Self::default()
        }
    }
}
