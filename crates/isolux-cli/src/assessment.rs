//! What a recording's frames say before and after standardization.

use std::collections::BTreeMap;

use isolux::evaluate::{Comparison, EvaluationFrame, EvaluationSettings, Evaluator, nearest_reference};
use isolux::still_scene::MotionWatch;
use isolux::{Calibration, Channels, Frame, IntegrationTime, PixelFlags, Plane, Standardized, Standardizer};
use isolux_io::Recording;

use crate::chain::{Chain, Smoothed};
use crate::console;
use crate::failure::{Failure, Outcome};
use crate::frames;
use crate::rivals::{Pass, Rivals, Standing};

/// Which pixels count.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Pixels {
    /// Before and after, those with a value.
    Valid,
    /// Before and after the same: those with a standardized value and neither LOW_SIGNAL nor SATURATED.
    Trusted,
}

/// What the frames of a recording say before and after standardization.
#[derive(Clone, Debug)]
pub(crate) struct Assessment {
    pub(crate) comparison: Comparison,
    /// The chains beside the chosen one.
    pub(crate) rivals: Vec<Standing>,
    /// Mean over the counted pixels at each integration time (µs, increasing), before and after.
    pub(crate) means: Vec<MeanAtTime>,
    /// A few frames that show the range: those of the shortest, the reference and the longest time, or the first,
    /// middle and last.
    pub(crate) shown_frames: Vec<usize>,
}

/// Means of the frames of one integration time.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MeanAtTime {
    pub(crate) time_us: f64,
    pub(crate) before_dn: f64,
    pub(crate) after_dn: f64,
}

/// Evaluates the raw and the standardized amplitude of the same frames. Two passes: one over the integration
/// times to find the reference exposure, one over the frames.
pub(crate) fn assess(
    recording: &mut dyn Recording,
    standardizer: &Standardizer,
    calibration: Option<&Calibration>,
    pixels: Pixels,
    rivals: Rivals,
) -> Outcome<Assessment> {
    let metadata = recording.metadata().clone();
    let reference_us = calibration
        .and_then(|c| c.reference.integration_time_us)
        .unwrap_or(isolux::calibration::REFERENCE_TIME_US);
    let mut evaluation = Both::new(&metadata, standardizer, pixels, rivals);
    let wanted = standardizer.needed()
        | evaluation.rivals.needed()
        | Channels::DISTANCE
        | Channels::INTEGRATION_TIME
        | Channels::TARGET;
    let times = times(recording)?;
    let reference = nearest_reference(times.iter().copied(), reference_us);
    if let Some(index) = reference {
        let mut frame = Frame::new(metadata.shape);
        evaluation.chain.read_alone(recording, index, wanted, &mut frame)?;
        evaluation
            .take(&frame, |evaluator, frame| evaluator.set_reference(frame))
            .map_err(|e| Failure::frame(&metadata.path, index, e))?;
        evaluation.chain.restart();
    }
    let (mut motion, mut last_us) = (MotionWatch::default(), None);
    frames::for_each(recording, wanted, "evaluating", |index, frame| {
        if let IntegrationTime::PerFrame(time_us) = frame.integration_time_us
            && last_us.replace(time_us) != Some(time_us)
        {
            motion.push(time_us, frame);
        }
        evaluation.push(frame).map_err(|error| Failure::frame(&metadata.path, index, error))
    })?;
    if let Some(movement) = motion.verdict() {
        console::warn(format!(
            "the scene did not stand still ({:.0} % of it is elsewhere at {} µs): figures over integration times \
             also show its movement",
            100.0 * movement.share,
            movement.integration_time_us
        ));
    }
    Ok(Assessment {
        comparison: Comparison::new(&evaluation.before, &evaluation.after),
        rivals: evaluation.rivals.standings(&evaluation.before),
        means: evaluation.means.into_values().map(|sums| sums.mean()).collect(),
        shown_frames: shown_frames(&times, reference),
    })
}

/// The one time of each frame, µs, where it has one.
fn times(recording: &mut dyn Recording) -> Outcome<Vec<Option<f64>>> {
    let mut times = Vec::new();
    frames::for_each(recording, Channels::INTEGRATION_TIME, "reading times", |_, frame| {
        times.push(match frame.integration_time_us {
            IntegrationTime::PerFrame(time_us) => Some(time_us),
            IntegrationTime::Unknown | IntegrationTime::PerPixel(_) => None,
        });
        Ok(())
    })?;
    Ok(times)
}

fn shown_frames(times: &[Option<f64>], reference: Option<usize>) -> Vec<usize> {
    let extreme = |wanted: fn(f64, f64) -> f64| times.iter().flatten().copied().reduce(wanted);
    let index_of = |time: Option<f64>| times.iter().position(|found| time.is_some() && *found == time);
    let mut shown = match reference {
        Some(reference) => vec![index_of(extreme(f64::min)), Some(reference), index_of(extreme(f64::max))],
        None => vec![Some(0), Some(times.len() / 2), times.len().checked_sub(1)],
    };
    shown.sort_unstable();
    shown.dedup();
    shown.into_iter().flatten().collect()
}

/// The two evaluators, what makes the second's frames, and the chains beside it.
struct Both<'a> {
    chain: Chain<'a>,
    smoothed: Smoothed,
    pixels: Pixels,
    rivals: Rivals,
    out: Standardized,
    trusted: Plane<PixelFlags>,
    before: Evaluator,
    after: Evaluator,
    /// Keyed by the bits of the (positive) time, which order like the times.
    means: BTreeMap<u64, Sums>,
}

/// Sums over the counted pixels of one integration time.
#[derive(Clone, Copy, Debug, Default)]
struct Sums {
    time_us: f64,
    /// Sum and count before.
    before: (f64, f64),
    /// Sum and count after.
    after: (f64, f64),
}

impl Sums {
    fn mean(&self) -> MeanAtTime {
        let Self { time_us, before, after } = *self;
        MeanAtTime { time_us, before_dn: before.0 / before.1, after_dn: after.0 / after.1 }
    }
}

fn add(sums: &mut (f64, f64), values: &Plane<f32>, flags: &Plane<PixelFlags>) {
    for (&value, flags) in values.values().iter().zip(flags.values()) {
        if !flags.contains(PixelFlags::INVALID) {
            *sums = (sums.0 + f64::from(value), sums.1 + 1.0);
        }
    }
}

impl<'a> Both<'a> {
    fn new(
        metadata: &isolux_io::Metadata,
        standardizer: &'a Standardizer,
        pixels: Pixels,
        rivals: Rivals,
    ) -> Self {
        let evaluator = || Evaluator::new(metadata.shape, EvaluationSettings::default());
        let chain = Chain::new(standardizer);
        let out = Standardized::new(metadata.shape);
        let trusted = Plane::filled(metadata.shape, PixelFlags::empty());
        Self {
            smoothed: chain.smoothed(),
            chain,
            pixels,
            rivals,
            out,
            trusted,
            before: evaluator(),
            after: evaluator(),
            means: BTreeMap::new(),
        }
    }

    fn take(&mut self, frame: &Frame, pass: Pass) -> Result<(), isolux::standardize::StandardizeError> {
        self.chain.standardize(frame, &mut self.smoothed, &mut self.out)?;
        if self.pixels == Pixels::Trusted {
            mark_distrusted(&self.out.flags, &mut self.trusted);
        }
        let (before_flags, after_flags) = match self.pixels {
            Pixels::Valid => (&frame.flags, &self.out.flags),
            Pixels::Trusted => (&self.trusted, &self.trusted),
        };
        let raw = EvaluationFrame::of_standardized(frame, &frame.amplitude, before_flags);
        let standardized = EvaluationFrame::of_standardized(frame, &self.out.amplitude, after_flags)
            .with_sigma(self.out.sigma.as_ref());
        let (before, after) =
            rayon::join(|| pass(&mut self.before, &raw), || pass(&mut self.after, &standardized));
        before?;
        after?;
        let trusted = (self.pixels == Pixels::Trusted).then_some(&self.trusted);
        self.rivals.take(frame, trusted, pass)
    }

    /// Takes a frame of the recording in its turn.
    fn push(&mut self, frame: &Frame) -> Result<(), isolux::standardize::StandardizeError> {
        self.take(frame, |evaluator, frame| evaluator.push(frame))?;
        if let IntegrationTime::PerFrame(time_us) = frame.integration_time_us {
            let (before_flags, after_flags) = self.flags(frame);
            let (mut before, mut after) = Default::default();
            add(&mut before, &frame.amplitude, before_flags);
            add(&mut after, &self.out.amplitude, after_flags);
            let sums = self.means.entry(time_us.to_bits()).or_default();
            sums.time_us = time_us;
            sums.before = (sums.before.0 + before.0, sums.before.1 + before.1);
            sums.after = (sums.after.0 + after.0, sums.after.1 + after.1);
        }
        Ok(())
    }

    /// The flags that decide which pixels count before and after.
    fn flags<'b>(&'b self, frame: &'b Frame) -> (&'b Plane<PixelFlags>, &'b Plane<PixelFlags>) {
        match self.pixels {
            Pixels::Valid => (&frame.flags, &self.out.flags),
            Pixels::Trusted => (&self.trusted, &self.trusted),
        }
    }
}

/// The flags with INVALID where a pixel is LOW_SIGNAL or SATURATED.
fn mark_distrusted(flags: &Plane<PixelFlags>, out: &mut Plane<PixelFlags>) {
    let distrusted = PixelFlags::LOW_SIGNAL | PixelFlags::SATURATED;
    for (out, &flags) in out.values_mut().iter_mut().zip(flags.values()) {
        *out = if flags.intersects(distrusted) { flags | PixelFlags::INVALID } else { flags };
    }
}
