//! The chains that an evaluation compares with the chosen one, on the same frames: the textbook's and the paper's.

use isolux::evaluate::{Comparison, EvaluationFrame, EvaluationSettings, Evaluator};
use isolux::standardize::StandardizeError;
use isolux::{
    Calibration, Channels, Choice, Frame, PixelFlags, Plane, RecordingTraits, Shape, Standardizer, Stream,
};

/// What is done with a frame by an evaluator.
pub(super) type Pass = fn(&mut Evaluator, &EvaluationFrame<'_>) -> Result<(), isolux::ShapeError>;

/// A chain beside the chosen one, and its figures.
#[derive(Clone, Debug)]
pub struct Standing {
    /// `textbook` or `paper`.
    pub name: &'static str,
    /// The names of its steps, in their order.
    pub steps: Vec<&'static str>,
    /// Against the raw amplitude.
    pub comparison: Comparison,
}

/// One rival with its stream and evaluator.
struct Rival {
    name: &'static str,
    stream: Stream,
    flags: Plane<PixelFlags>,
    evaluator: Evaluator,
}

/// All of them.
pub(super) struct Rivals(Vec<Rival>);

impl Rivals {
    /// No rivals.
    pub(super) fn none() -> Self {
        Self(Vec::new())
    }

    /// The rivals that recording and calibration allow and that differ from `chosen`.
    pub(super) fn new(
        chosen: &Standardizer,
        calibration: Option<&Calibration>,
        traits: RecordingTraits,
        shape: Shape,
    ) -> Self {
        let rival = |(name, choice): (&'static str, Choice)| {
            // A chain that cannot be planned for this recording is left out.
            let standardizer = Standardizer::plan(&choice, calibration, traits.clone()).ok()?;
            let same = does_the_same(&standardizer, chosen) || standardizer.steps().is_empty();
            let evaluator = Evaluator::new(shape, EvaluationSettings::default());
            let flags = Plane::filled(shape, PixelFlags::empty());
            (!same).then(|| Rival { name, stream: standardizer.stream(), flags, evaluator })
        };
        let chains = [("textbook", Choice::textbook(traits.channels)), ("paper", Choice::paper())];
        Self(chains.into_iter().filter_map(rival).collect())
    }

    /// The channels that they read.
    pub(super) fn needed(&self) -> Channels {
        self.0.iter().fold(Channels::empty(), |all, rival| all | rival.stream.standardizer().needed())
    }

    /// Takes a frame. Pixels that are INVALID in `trusted`, where it is given, do not count.
    pub(super) fn take(
        &mut self,
        frame: &Frame,
        trusted: Option<&Plane<PixelFlags>>,
        pass: Pass,
    ) -> Result<(), StandardizeError> {
        for rival in &mut self.0 {
            let out = rival.stream.push(frame)?;
            rival.flags.reshape(frame.shape(), PixelFlags::empty());
            rival.flags.values_mut().copy_from_slice(out.flags.values());
            let trusted = trusted.into_iter().flat_map(Plane::values);
            for (flags, trusted) in rival.flags.values_mut().iter_mut().zip(trusted) {
                *flags |= *trusted & PixelFlags::INVALID;
            }
            let values = EvaluationFrame::of_standardized(frame, &out.amplitude, &rival.flags);
            pass(&mut rival.evaluator, &values)?;
        }
        Ok(())
    }

    /// The figures of every rival, compared with those of the raw amplitude.
    pub(super) fn standings(&self, raw: &Evaluator) -> Vec<Standing> {
        let standing = |rival: &Rival| Standing {
            name: rival.name,
            steps: rival.stream.standardizer().steps().iter().map(|step| step.term).collect(),
            comparison: Comparison::new(raw, &rival.evaluator),
        };
        self.0.iter().map(standing).collect()
    }
}

/// Whether a chain without a step for highlights scales like the chosen one, or is the chosen one.
fn does_the_same(rival: &Standardizer, chosen: &Standardizer) -> bool {
    let limits = rival.steps().iter().any(|step| step.effect == "specular");
    let scales = |effect: &str| effect != "sigma" && (limits || effect != "specular");
    let scaling = chosen.steps().iter().filter(|step| scales(step.effect));
    rival.steps().iter().eq(scaling)
}
