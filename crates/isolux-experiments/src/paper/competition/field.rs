//! The field: identical frames and identical pixels for every competitor.

use isolux::evaluate::{Comparison, EvaluationFrame, EvaluationSettings, Evaluator, nearest_reference};
use isolux::{Frame, PixelFlags, Plane, Standardizer, Window};
use rayon::prelude::*;

use super::methods::Competitor;
use crate::error::ExperimentError;
use crate::measure::{WINDOW_PX, for_each, kept, simulation, time_us};
use crate::paper::lab::Lab;

/// Which frames and pixels enter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Selection {
    /// All frames, every pixel that all competitors have.
    All,
    /// The same from 1 ms on.
    From1Ms,
    /// From 1 ms on, without the pixels that are near the noise floor.
    Bright,
}

/// Shortest integration time of the later selections, µs.
pub(super) const SHORTEST_US: f64 = 1000.0;

impl Selection {
    /// Every selection.
    pub(super) const ALL: [Self; 3] = [Self::All, Self::From1Ms, Self::Bright];

    /// In identifiers.
    pub(super) fn id(self) -> &'static str {
        match self {
            Self::All => "all",
            Self::From1Ms => "from-1-ms",
            Self::Bright => "bright",
        }
    }

    /// In words.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::All => "all integration times",
            Self::From1Ms => "integration times from 1 ms",
            Self::Bright => "integration times from 1 ms, LOW_SIGNAL pixels left out",
        }
    }

    fn has(self, frame: &Frame) -> bool {
        self == Self::All || time_us(frame).is_some_and(|time_us| time_us >= SHORTEST_US)
    }

    fn excludes(self, flags: PixelFlags) -> bool {
        self == Self::Bright && flags.contains(PixelFlags::LOW_SIGNAL)
    }
}

/// Frames, and the pixels of each that every competitor has.
pub(super) struct Field {
    frames: Vec<Frame>,
    /// INVALID where any competitor has no value; LOW_SIGNAL as all of them see it.
    flags: Vec<Plane<PixelFlags>>,
    standardizers: Vec<(Competitor, Standardizer)>,
    /// Share of pixels that each competitor has by itself, 0..=1.
    own_valid: Vec<f64>,
    /// Share of its linear amplitude that a pixel keeps in the last frame, the longest exposure: 5 % quantile, so
    /// of the pixels that saturate most.
    pub(super) kept_at_longest: f64,
}

/// What one competitor reaches.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Standing {
    /// Who.
    pub(super) competitor: Competitor,
    /// Against the raw amplitude of the same pixels.
    pub(super) comparison: Comparison,
    /// Share of the pixels of all frames that it has by itself, 0..=1.
    pub(super) own_valid: f64,
}

impl Field {
    /// The frames of a built-in scene.
    ///
    /// # Errors
    /// [`ExperimentError`], which no seed should bring about.
    pub(super) fn new(lab: &Lab, scene: &str, competitors: &[Competitor]) -> Result<Self, ExperimentError> {
        let mut frames = Vec::new();
        let simulated = simulation(scene, lab.seed)?;
        let mut kept_at_longest = f64::NAN;
        for_each(&simulated, |_, simulated| {
            kept_at_longest = kept(&simulated.truth);
            // Without the raw bins, which nobody reads here.
            frames.push(Frame { phase_samples: None, ..simulated.frame.clone() });
            Ok(())
        })?;
        let plan = |competitor: &Competitor| Ok((*competitor, competitor.standardizer(&lab.calibration)?));
        let standardizers = competitors.iter().map(plan).collect::<Result<Vec<_>, ExperimentError>>()?;
        let shared: Vec<(Plane<PixelFlags>, Vec<usize>)> =
            frames.par_iter().map(|frame| shared_flags(frame, &standardizers)).collect::<Result<_, _>>()?;
        let pixels = frames.len() * simulated.shape().pixels();
        let own =
            |index: usize| shared.iter().map(|(_, valid)| valid[index]).sum::<usize>() as f64 / pixels as f64;
        let own_valid = (0..competitors.len()).map(own).collect();
        let flags = shared.into_iter().map(|(flags, _)| flags).collect();
        Ok(Self { frames, flags, standardizers, own_valid, kept_at_longest })
    }

    /// Labels the paper's central window alone, so that near and far frames show the same part of the
    /// illumination.
    pub(super) fn label_centre(&mut self) {
        for frame in &mut self.frames {
            let shape = frame.shape();
            let mut target = Plane::filled(shape, 0);
            Window::centred(shape, WINDOW_PX).indices(shape).for_each(|index| target.values_mut()[index] = 1);
            frame.target = Some(target);
        }
    }

    /// Everybody's figures on the selected frames and pixels; those that need a reference frame only with a
    /// `reference_us`, as they take the most time.
    ///
    /// # Errors
    /// [`ExperimentError`], which no seed should bring about.
    pub(super) fn contest(
        &self,
        selection: Selection,
        reference_us: Option<f64>,
    ) -> Result<Vec<Standing>, ExperimentError> {
        let raw = self.evaluate(None, selection, reference_us)?;
        let compete = |((competitor, standardizer), own_valid): (&(Competitor, Standardizer), &f64)| {
            let after = self.evaluate(Some(standardizer), selection, reference_us)?;
            let comparison = Comparison::new(&raw, &after);
            Ok(Standing { competitor: *competitor, comparison, own_valid: *own_valid })
        };
        self.standardizers.par_iter().zip(&self.own_valid).map(compete).collect()
    }

    /// Pushes the selected frames, standardized or raw.
    fn evaluate(
        &self,
        standardizer: Option<&Standardizer>,
        selection: Selection,
        reference_us: Option<f64>,
    ) -> Result<Evaluator, ExperimentError> {
        let selected: Vec<usize> =
            (0..self.frames.len()).filter(|index| selection.has(&self.frames[*index])).collect();
        let times = selected.iter().map(|index| time_us(&self.frames[*index]));
        let reference = reference_us.and_then(|reference_us| nearest_reference(times, reference_us));
        let reference = reference.map(|position| selected[position]);
        let shape = self.frames[0].shape();
        let mut evaluator = Evaluator::new(shape, EvaluationSettings::default());
        let mut stream = standardizer.map(Standardizer::stream);
        for (is_reference, index) in reference
            .into_iter()
            .map(|index| (true, index))
            .chain(selected.iter().map(|index| (false, *index)))
        {
            let frame = &self.frames[index];
            let flags = self.flags_for(index, selection);
            let values = match &mut stream {
                Some(stream) => &stream.push(frame)?.amplitude,
                None => &frame.amplitude,
            };
            let frame = EvaluationFrame::of_standardized(frame, values, &flags);
            if is_reference { evaluator.set_reference(&frame)? } else { evaluator.push(&frame)? }
        }
        Ok(evaluator)
    }

    fn flags_for(&self, index: usize, selection: Selection) -> Plane<PixelFlags> {
        let mut flags = self.flags[index].clone();
        for flags in flags.values_mut() {
            flags.set(PixelFlags::INVALID, flags.contains(PixelFlags::INVALID) || selection.excludes(*flags));
        }
        flags
    }
}

/// All competitors' flags together, and how many pixels each has by itself.
fn shared_flags(
    frame: &Frame,
    standardizers: &[(Competitor, Standardizer)],
) -> Result<(Plane<PixelFlags>, Vec<usize>), ExperimentError> {
    let (mut shared, mut valid) = (frame.flags.clone(), Vec::new());
    for (_, standardizer) in standardizers {
        let mut stream = standardizer.stream();
        let out = stream.push(frame)?;
        valid.push(out.summary.valid);
        for (shared, own) in shared.values_mut().iter_mut().zip(out.flags.values()) {
            *shared |= *own;
        }
    }
    Ok((shared, valid))
}
