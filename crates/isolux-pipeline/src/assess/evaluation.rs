//! The raw and the standardized frames of a recording in their evaluators.

use std::collections::BTreeMap;

use isolux::evaluate::{EvaluationFrame, EvaluationSettings, Evaluator};
use isolux::standardize::StandardizeError;
use isolux::{Frame, IntegrationTime, PixelFlags, Plane, Shape, Standardized, Standardizer, Stream};

use super::assessment::{MeanAtTime, Pixels};
use super::rivals::{Pass, Rivals};

/// The two evaluators, what makes the second's frames, and the chains beside it.
pub(super) struct Evaluation {
    pub(super) stream: Stream,
    pixels: Pixels,
    pub(super) rivals: Rivals,
    trusted: Plane<PixelFlags>,
    pub(super) before: Evaluator,
    pub(super) after: Evaluator,
    /// Keyed by the bits of the (positive) time, which order like the times.
    means: BTreeMap<u64, TimeSums>,
}

impl Evaluation {
    pub(super) fn new(shape: Shape, standardizer: &Standardizer, pixels: Pixels, rivals: Rivals) -> Self {
        let evaluator = || Evaluator::new(shape, EvaluationSettings::default());
        Self {
            stream: standardizer.stream(),
            pixels,
            rivals,
            trusted: Plane::filled(shape, PixelFlags::empty()),
            before: evaluator(),
            after: evaluator(),
            means: BTreeMap::new(),
        }
    }

    /// Standardizes a frame and hands both to `pass`.
    pub(super) fn take(&mut self, frame: &Frame, pass: Pass) -> Result<(), StandardizeError> {
        let out = self.stream.push(frame)?;
        if self.pixels == Pixels::Trusted {
            mark_distrusted(&out.flags, &mut self.trusted);
        }
        let (before_flags, after_flags) = counted(self.pixels, &self.trusted, frame, out);
        let raw = EvaluationFrame::of_standardized(frame, &frame.amplitude, before_flags);
        let standardized = EvaluationFrame::of_standardized(frame, &out.amplitude, after_flags)
            .with_sigma(out.sigma.as_ref());
        let (before, after) =
            rayon::join(|| pass(&mut self.before, &raw), || pass(&mut self.after, &standardized));
        before?;
        after?;
        let trusted = (self.pixels == Pixels::Trusted).then_some(&self.trusted);
        self.rivals.take(frame, trusted, pass)
    }

    /// Takes a frame of the recording in its turn.
    pub(super) fn push(&mut self, frame: &Frame) -> Result<(), StandardizeError> {
        self.take(frame, |evaluator, frame| evaluator.push(frame))?;
        if let IntegrationTime::PerFrame(time_us) = frame.integration_time_us {
            let out = self.stream.last();
            let (before_flags, after_flags) = counted(self.pixels, &self.trusted, frame, out);
            let before = ValueSum::of(&frame.amplitude, before_flags);
            let after = ValueSum::of(&out.amplitude, after_flags);
            let sums = self.means.entry(time_us.to_bits()).or_default();
            sums.time_us = time_us;
            sums.before.add(before);
            sums.after.add(after);
        }
        Ok(())
    }

    /// Means at each integration time, increasing.
    pub(super) fn means(&self) -> Vec<MeanAtTime> {
        self.means.values().map(TimeSums::mean).collect()
    }
}

/// The flags that decide which pixels count, raw and standardized.
fn counted<'a>(
    pixels: Pixels,
    trusted: &'a Plane<PixelFlags>,
    frame: &'a Frame,
    out: &'a Standardized,
) -> (&'a Plane<PixelFlags>, &'a Plane<PixelFlags>) {
    match pixels {
        Pixels::Valid => (&frame.flags, &out.flags),
        Pixels::Trusted => (trusted, trusted),
    }
}

/// Sums over the counted pixels of one integration time.
#[derive(Clone, Copy, Debug, Default)]
struct TimeSums {
    time_us: f64,
    before: ValueSum,
    after: ValueSum,
}

impl TimeSums {
    fn mean(&self) -> MeanAtTime {
        let Self { time_us, before, after } = *self;
        MeanAtTime { time_us, before_dn: before.sum / before.count, after_dn: after.sum / after.count }
    }
}

#[derive(Clone, Copy, Debug, Default)]
struct ValueSum {
    sum: f64,
    count: f64,
}

impl ValueSum {
    /// Of the values without INVALID.
    fn of(values: &Plane<f32>, flags: &Plane<PixelFlags>) -> Self {
        let mut found = Self::default();
        for (&value, flags) in values.values().iter().zip(flags.values()) {
            if !flags.contains(PixelFlags::INVALID) {
                found.add(Self { sum: f64::from(value), count: 1.0 });
            }
        }
        found
    }

    fn add(&mut self, other: Self) {
        self.sum += other.sum;
        self.count += other.count;
    }
}

/// The flags with INVALID where a pixel is LOW_SIGNAL or SATURATED.
fn mark_distrusted(flags: &Plane<PixelFlags>, out: &mut Plane<PixelFlags>) {
    let distrusted = PixelFlags::LOW_SIGNAL | PixelFlags::SATURATED;
    for (out, &flags) in out.values_mut().iter_mut().zip(flags.values()) {
        *out = if flags.intersects(distrusted) { flags | PixelFlags::INVALID } else { flags };
    }
}
