//! What each rule does to one image: where it cuts, what it limits, and how much of the bright foreground's
//! structure it leaves.

use isolux::specular::{HistogramRule, KneeRule, PercentRule, SigmaRule, SpecularRule};
use isolux::standardize::{DistanceStep, SpecularStep, TimeStep};
use isolux::statistics::quantile;
use isolux::{PixelFlags, Plane};
use isolux_camera::SimulatedFrame;

use crate::error::ExperimentError;
use crate::paper::lab::Lab;
use crate::structure::{Structure, kept};

/// Surfaces of the bright foreground reflect at least this much: the board and the light stripes of the tin.
const FOREGROUND_REFLECTIVITY: f32 = 0.5;
/// They are nearer than this; the wall behind is at 2 m.
const FOREGROUND_DISTANCE_M: f32 = 1.2;
/// Matt pixels owe at most this share of their light to a highlight.
const MATT_SPECULAR_FRACTION: f32 = 0.01;
/// Pixels of a highlight owe it more than this share of their light.
const HIGHLIGHT_SPECULAR_FRACTION: f32 = 0.5;
/// The brightest matt value, without stray pixels.
const BRIGHTEST_FRACTION: f64 = 0.999;

/// The rules in the order of the page: the paper's, then the one that keeps the order of the highlights.
pub(super) const RULES: [(&str, SpecularRule); 5] = [
    ("0.9 of maximum", SpecularRule::Percent(PercentRule::OfMaximum(0.9))),
    ("upper 10 %", SpecularRule::Percent(PercentRule::Quantile(0.9))),
    ("mean + 4σ", SpecularRule::Sigma(SigmaRule { deviations: 4.0 })),
    ("histogram", SpecularRule::Histogram(HistogramRule { occurrences: None })),
    ("knee", SpecularRule::Knee(KneeRule { cutoff: HistogramRule { occurrences: None } })),
];

/// Places of the rules in [`RULES`].
pub(super) const OF_MAXIMUM: usize = 0;
pub(super) const UPPER_TENTH: usize = 1;
pub(super) const SIGMA: usize = 2;
pub(super) const HISTOGRAM: usize = 3;

/// One image under all rules.
pub(super) struct Case {
    /// Without any rule; NaN where there is no measurement.
    pub(super) before: Plane<f32>,
    /// Share of the bright foreground in all pixels.
    pub(super) foreground_share: f64,
    /// Number of pixels of highlights.
    pub(super) highlight_pixels: usize,
    /// Brightest matt value / maximum before.
    pub(super) range_used: f64,
    /// In the order of [`RULES`].
    pub(super) outcomes: [Outcome; RULES.len()],
}

/// One image under one rule. Shares are 0..1.
pub(super) struct Outcome {
    /// The limited image.
    pub(super) after: Plane<f32>,
    /// Largest value that is left: the cutoff where anything was limited, DN.
    pub(super) maximum_dn: f64,
    /// Share of the valid pixels that were limited.
    pub(super) limited: f64,
    /// Share of the highlights' pixels that were limited.
    pub(super) highlight_limited: f64,
    /// Share of the foreground's pixels that were limited.
    pub(super) foreground_limited: f64,
    /// What is left within the foreground.
    pub(super) structure: Structure,
    /// Brightest matt value / maximum: how much of the grey scale the scene without highlights uses.
    pub(super) range_used: f64,
}

/// Parts of an image, by the simulation's truth; only pixels with a value.
struct Parts {
    valid: Vec<bool>,
    foreground: Vec<bool>,
    highlight: Vec<bool>,
    matt: Vec<bool>,
}

impl Case {
    /// Applies every rule after the steps `time` and `distance`.
    pub(super) fn measure(
        lab: &Lab,
        simulated: &SimulatedFrame,
        time: TimeStep,
        distance: DistanceStep,
    ) -> Result<Self, ExperimentError> {
        let before = lab.apply(&simulated.frame, time, distance, SpecularStep::None)?.amplitude;
        let parts = Parts::of(simulated, &before);
        let outcome = |(_, rule): (&str, SpecularRule)| -> Result<Outcome, ExperimentError> {
            let out = lab.apply(&simulated.frame, time, distance, SpecularStep::Limit(rule))?;
            let limited: Vec<bool> =
                out.flags.values().iter().map(|flags| flags.contains(PixelFlags::SPECULAR)).collect();
            Ok(Outcome {
                maximum_dn: maximum(&out.amplitude),
                limited: share(&limited, &parts.valid),
                highlight_limited: share(&limited, &parts.highlight),
                foreground_limited: share(&limited, &parts.foreground),
                structure: kept(&before, &out.amplitude, &parts.foreground),
                range_used: range_used(&out.amplitude, &parts.matt),
                after: out.amplitude,
            })
        };
        let [first, second, third, fourth, fifth] = RULES.map(outcome);
        Ok(Self {
            foreground_share: share(&parts.foreground, &vec![true; parts.foreground.len()]),
            highlight_pixels: parts.highlight.iter().filter(|member| **member).count(),
            range_used: range_used(&before, &parts.matt),
            before,
            outcomes: [first?, second?, third?, fourth?, fifth?],
        })
    }
}

impl Outcome {
    /// The smallest of the three measures of structure.
    pub(super) fn least_kept(&self) -> f64 {
        let Structure { deviation_ratio, gradient_correlation, kendall_tau } = self.structure;
        deviation_ratio.min(gradient_correlation).min(kendall_tau)
    }
}

impl Parts {
    fn of(simulated: &SimulatedFrame, image: &Plane<f32>) -> Self {
        let truth = &simulated.truth;
        let valid: Vec<bool> = image.values().iter().map(|value| value.is_finite()).collect();
        let part = |belongs: &dyn Fn(usize) -> bool| -> Vec<bool> {
            (0..valid.len()).map(|index| valid[index] && belongs(index)).collect()
        };
        let specular = |index: usize| truth.specular_fraction.values()[index];
        let foreground = |index: usize| {
            truth.reflectivity.values()[index] >= FOREGROUND_REFLECTIVITY
                && truth.true_distance_m.values()[index] < FOREGROUND_DISTANCE_M
                && specular(index) < MATT_SPECULAR_FRACTION
        };
        Self {
            foreground: part(&foreground),
            highlight: part(&|index| specular(index) > HIGHLIGHT_SPECULAR_FRACTION),
            matt: part(&|index| specular(index) < MATT_SPECULAR_FRACTION),
            valid,
        }
    }
}

/// Share of the pixels `of` that are also in `members`; NaN for an empty part.
fn share(members: &[bool], of: &[bool]) -> f64 {
    let both = members.iter().zip(of).filter(|(member, of)| **member && **of).count();
    both as f64 / of.iter().filter(|of| **of).count() as f64
}

fn maximum(image: &Plane<f32>) -> f64 {
    f64::from(image.values().iter().copied().filter(|value| value.is_finite()).fold(0.0, f32::max))
}

fn range_used(image: &Plane<f32>, matt: &[bool]) -> f64 {
    let values = image.values().iter().zip(matt).filter(|(_, matt)| **matt);
    let mut values: Vec<f64> = values.map(|(value, _)| f64::from(*value)).collect();
    quantile(&mut values, BRIGHTEST_FRACTION).map_or(f64::NAN, |brightest| brightest / maximum(image))
}
