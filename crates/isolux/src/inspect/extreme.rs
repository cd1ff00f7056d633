//! Codes that nothing names: many pixels share the largest value, far from all others.

use crate::frame::{Frame, PixelFlags};

/// A largest value that fewer of the sampled pixels share may be chance.
const SHARED_VALUES: usize = 8;
/// ... and this share of them: a code is no accident.
const SHARED_SHARE: f64 = 5e-4;
/// A measured value that clips is followed closely by those just below it. A code stands apart: between it and the
/// largest of the others nothing lies, over this share of its value.
const GAP_SHARE: f64 = 0.04;

/// The largest value of a channel, where it is a code.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Extreme {
    pub(super) value: f32,
    /// Share of the pixels with a value that have it, 0..=1.
    pub(super) share: f64,
    /// Largest of the other values.
    pub(super) others: f32,
}

/// Sampled values of one channel.
#[derive(Clone, Debug, Default)]
pub(super) struct Values(Vec<f32>);

impl Values {
    /// Takes every `stride`th amplitude that is valid.
    pub(super) fn push_amplitudes(&mut self, frame: &Frame, stride: usize) {
        let values = frame.amplitude.values().iter().zip(frame.flags.values()).step_by(stride);
        let valid = values.filter(|(_, flags)| !flags.contains(PixelFlags::INVALID));
        self.0.extend(valid.map(|(&value, _)| value));
    }

    /// Takes every `stride`th distance that is one.
    pub(super) fn push_distances(&mut self, frame: &Frame, stride: usize) {
        let values = frame.distance_m.iter().flat_map(|plane| plane.values().iter().step_by(stride));
        self.0.extend(values.copied().filter(|d| *d > 0.0 && d.is_finite()));
    }

    /// The largest value, where it is a code.
    pub(super) fn extreme(&mut self) -> Option<Extreme> {
        let value = self.0.iter().copied().reduce(f32::max)?;
        let count = self.0.iter().filter(|&&other| other == value).count();
        let share = count as f64 / self.0.len() as f64;
        let others = self.0.iter().copied().filter(|&other| other < value).reduce(f32::max)?;
        let apart = f64::from(value - others) > GAP_SHARE * f64::from(value);
        (apart && count >= SHARED_VALUES && share >= SHARED_SHARE).then_some(Extreme { value, share, others })
    }
}
