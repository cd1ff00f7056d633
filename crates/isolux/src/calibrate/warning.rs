//! What the user should know of a fit, or record better.

use std::fmt;

use super::joint::{JointError, Refusal};
use super::scene::MotionRefusal;
use crate::terms::cubic::{Decay, DecayUse, Scaling};
use crate::terms::lut::LutError;
use crate::terms::response::ResponseError;
use crate::terms::spline::{SplineError, SplineUse};

/// One finding about a recording or a fit, with its numbers.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum FitWarning {
    /// The integration times of a sweep do not increase.
    TimesNotIncreasing {
        /// The recording.
        recording: String,
    },
    /// Amplitudes drift after each change of the integration time.
    Settling {
        /// The recording.
        recording: String,
        /// First frame against last of a run, relative, median over runs.
        relative_drift: f64,
    },
    /// The scene of an exposure sweep did not stand still.
    SceneMoved {
        /// The recording.
        recording: String,
        /// Time at which it stood elsewhere, µs.
        integration_time_us: f64,
        /// Share of the image that moved.
        share: f64,
    },
    /// An integration time at which a frame has no pixel with a value.
    NoMeasurement {
        /// The recording.
        recording: String,
        /// The time, µs.
        integration_time_us: f64,
    },
    /// Few integration times.
    TooFewTimes {
        /// The recording.
        recording: String,
        /// Number found.
        found: usize,
    },
    /// Pixels with the saturation code inside the range of the table.
    SaturationInSweep {
        /// The recording.
        recording: String,
        /// From this time on, µs.
        from_us: f64,
        /// Largest share of the pixels.
        share: f64,
    },
    /// Frames of a distance sweep whose window is saturated or empty.
    SaturationInWindow {
        /// The recording.
        recording: String,
        /// Frames left out for it.
        frames: usize,
    },
    /// Frames of a distance sweep whose distances scatter too much.
    UnreliableDistances {
        /// The recording.
        recording: String,
        /// Frames left out for it.
        frames: usize,
    },
    /// A decay left out because few of its frames have a reliable distance.
    FewReliable {
        /// The recording.
        recording: String,
        /// Integration time, µs.
        integration_time_us: Option<f64>,
        /// Frames with a reliable distance.
        reliable: usize,
        /// All its frames.
        frames: usize,
    },
    /// Near positions where the amplitude falls towards the camera: over-saturation.
    OverSaturated {
        /// The recording.
        recording: String,
        /// Integration time, µs.
        integration_time_us: Option<f64>,
        /// Positions left out.
        positions: usize,
        /// Usable from here on, m.
        from_m: f64,
    },
    /// A decay left out because its signal is too weak.
    LowSignal {
        /// The recording.
        recording: String,
        /// Integration time, µs.
        integration_time_us: Option<f64>,
        /// Median signal-to-noise ratio in the window.
        signal_to_noise: f64,
    },
    /// The target is tilted or not flat.
    TargetNotFronto {
        /// The recording.
        recording: String,
        /// Frame with the largest spread, from 0.
        frame: usize,
        /// Distance from one side of the window to the other, m.
        spread_m: f64,
    },
    /// The target moved while one position was recorded.
    TargetMoved {
        /// The recording.
        recording: String,
        /// First frame of the position, from 0.
        frame: usize,
        /// Range of the mean distances, m.
        range_m: f64,
    },
    /// Few positions.
    TooFewDistances {
        /// Integration time, µs.
        integration_time_us: Option<f64>,
        /// Number found.
        found: usize,
    },
    /// A decay that could not be brought to the common scale.
    NoOverlap {
        /// Integration time, µs.
        integration_time_us: Option<f64>,
    },
    /// A tier of the response that the recordings have the channels for, but do not determine.
    NoTier {
        /// The tier.
        tier: &'static str,
        /// Why.
        reason: ResponseError,
    },
    /// No spline beside the cubic.
    NoSpline {
        /// Why.
        reason: SplineError,
    },
    /// Many positions of a decay that contradict those of the others.
    Outliers {
        /// Integration time, µs.
        integration_time_us: Option<f64>,
        /// Positions without a weight in the spline.
        outliers: usize,
        /// All its positions.
        positions: usize,
    },
    /// A target's recording without a window that can be measured.
    NoWindows {
        /// The recording.
        recording: String,
    },
    /// A target's recording without intrinsics.
    NoIntrinsics {
        /// The recording.
        recording: String,
    },
    /// A target's recording whose distances give no planes.
    FewNormals {
        /// The recording.
        recording: String,
        /// Windows without an angle.
        windows: usize,
        /// All its windows.
        of: usize,
    },
    /// A material left out because of its gloss.
    Glossy {
        /// The recording.
        recording: String,
        /// Its label.
        label: u8,
        /// Exponent of its cosine.
        exponent: f64,
    },
    /// A factor that the targets do not determine.
    FactorRefused {
        /// What was observed: `targets` or `scenes`.
        of: &'static str,
        /// Why.
        reason: Refusal,
        /// Unknowns of the model beside the materials' brightnesses.
        unknowns: usize,
        /// Rank of its reduced normal matrix.
        rank: usize,
    },
    /// The other factors were fitted with Lambert's cosine.
    LambertAssumed,
    /// A distance law that was seen, but not at the reference distance.
    ReferenceNotSeen {
        /// What was observed: `targets` or `scenes`.
        of: &'static str,
        /// Reference, m.
        reference_m: f64,
        /// Distances that were seen, m.
        seen_m: [f64; 2],
    },
    /// A scene whose motion could not be told.
    MotionRefused {
        /// The recording.
        recording: String,
        /// Why.
        reason: MotionRefusal,
    },
    /// A scene without two looks at anything.
    SceneUseless {
        /// The recording.
        recording: String,
    },
    /// Scenes from which nothing could be fitted.
    NothingFromScenes {
        /// Why.
        reason: JointError,
    },
    /// A scene in which neither camera nor integration time changes.
    NothingVaries,
    /// Integration times that scenes give no table of.
    NoTable {
        /// Why.
        reason: LutError,
    },
    /// A term that scenes determine, but something better is there.
    TermKept {
        /// The term.
        term: &'static str,
    },
}

impl fmt::Display for FitWarning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::TimesNotIncreasing { recording } => write!(
                f,
                "{recording}: the integration times do not increase throughout; a warm camera then meets other \
                 conditions than a cold one: sweep upwards, and skip the settling frames"
            ),
            Self::Settling { recording, relative_drift } => write!(
                f,
                "{recording}: after a change of the integration time, the first frames differ from the last by \
                 {:.1} %: drop them with --skip-frames",
                100.0 * relative_drift
            ),
            Self::SceneMoved { recording, integration_time_us, share } => write!(
                f,
                "{recording}: at {integration_time_us} µs, {:.0} % of the image is at another distance than \
                 usual: an exposure sweep needs a still scene",
                100.0 * share
            ),
            Self::NoMeasurement { recording, integration_time_us } => write!(
                f,
                "{recording}: {integration_time_us} µs left out, a frame there has no valid pixel (dark, or all \
                 saturated)"
            ),
            Self::TooFewTimes { recording, found } => {
                write!(
                    f,
                    "{recording}: {found} usable integration times; record 8 or more, evenly spread in ln t"
                )
            }
            Self::SaturationInSweep { recording, from_us, share } => write!(
                f,
                "{recording}: from {from_us} µs on, up to {:.1} % of the pixels carry the saturation code and \
                 drop out of the mean: use a darker or more distant wall",
                100.0 * share
            ),
            Self::SaturationInWindow { recording, frames } => write!(
                f,
                "{recording}: {frames} frames left out, saturated or invalid in more than 5 % of the window: \
                 start farther away at long integration times"
            ),
            Self::UnreliableDistances { recording, frames } => write!(
                f,
                "{recording}: {frames} frames left out, the distances in the window scatter by more than 10 %: \
                 over-saturated, or too dark"
            ),
            Self::FewReliable { recording, integration_time_us, reliable, frames } => write!(
                f,
                "{recording}, {}: left out, only {reliable} of its {frames} frames have reliable distances",
                time(*integration_time_us)
            ),
            Self::OverSaturated { recording, integration_time_us, positions, from_m } => write!(
                f,
                "{recording}, {}: {positions} position(s) nearer than {from_m:.3} m left out as over-saturated",
                time(*integration_time_us)
            ),
            Self::LowSignal { recording, integration_time_us, signal_to_noise } => write!(
                f,
                "{recording}, {}: left out, the signal-to-noise ratio of {signal_to_noise:.1} is below 10 and its \
                 distances are not reliable",
                time(*integration_time_us)
            ),
            Self::TargetNotFronto { recording, frame, spread_m } => write!(
                f,
                "{recording}, frame {frame}: the distance changes by {:.0} mm across the window: turn the target \
                 to face the camera, or use a smaller --window",
                1000.0 * spread_m
            ),
            Self::TargetMoved { recording, frame, range_m } => write!(
                f,
                "{recording}: from frame {frame} on, the target moves by {:.0} mm within one position: let it \
                 stand still",
                1000.0 * range_m
            ),
            Self::TooFewDistances { integration_time_us, found } => {
                write!(
                    f,
                    "distance sweep, {}: {found} positions; record 8 or more",
                    time(*integration_time_us)
                )
            }
            Self::NoOverlap { integration_time_us } => write!(
                f,
                "distance sweep, {}: left out, it neither reaches the reference distance nor overlaps the others",
                time(*integration_time_us)
            ),
            Self::NoTier { tier, reason } => {
                write!(f, "no response by `{tier}`: {reason}")
            }
            Self::NoSpline { reason } => write!(f, "distance sweep: no spline beside the cubic: {reason}"),
            Self::Outliers { integration_time_us, outliers, positions } => write!(
                f,
                "distance sweep, {}: {outliers} of {positions} positions contradict the other times and do not count \
                 in the spline: saturated, or another target",
                time(*integration_time_us)
            ),
            Self::NoWindows { recording } => write!(
                f,
                "{recording}: no window of 5×5 pixels inside a label of `target` that is measured, unsaturated and bright \
                 enough: nothing to learn from it"
            ),
            Self::NoIntrinsics { recording } => write!(
                f,
                "{recording}: no intrinsics {{fx, fy, cx, cy}} in recording.json, so no angles of incidence: its windows \
                 count for no angle"
            ),
            Self::FewNormals { recording, windows, of } => write!(
                f,
                "{recording}: {windows} of {of} windows lie on no plane: their distances are too noisy or too few"
            ),
            Self::Glossy { recording, label, exponent } => write!(
                f,
                "{recording}: label {label} left out, its amplitude goes with cos^{exponent:.1}θ: a glossy material has its \
                 own angle law"
            ),
            Self::FactorRefused { of, reason, unknowns, rank } => {
                write!(f, "{of}: no {reason} (rank {rank} of {unknowns} unknowns)")
            }
            Self::LambertAssumed => f.write_str(
                "targets: the other factors are fitted with Lambert's cosine, which was not measured: a glossy target \
                 bends them",
            ),
            Self::ReferenceNotSeen { of, reference_m, seen_m: [min_m, max_m] } => write!(
                f,
                "{of}: no spline, the {of} were seen from {min_m:.3} to {max_m:.3} m and not at the reference distance \
                 of {reference_m} m: record there, or choose another with --reference-distance-m"
            ),
            Self::MotionRefused { recording, reason } => write!(f, "{recording}: left out, {reason}"),
            Self::SceneUseless { recording } => write!(
                f,
                "{recording}: left out, no surface was found in two frames: too dim, too textured, too few frames, or \
                 everything moved"
            ),
            Self::NothingFromScenes { reason } => write!(f, "scenes: no term, {reason}"),
            Self::NothingVaries => f.write_str(
                "scenes: no term, neither the camera nor the integration time changes: whatever the amplitudes are, it may \
                 be the surfaces' reflectivity",
            ),
            Self::NoTable { reason } => write!(f, "scenes: no lut, {reason}"),
            Self::TermKept { term } => {
                write!(f, "scenes: `{term}` is that of the sweeps or targets, which know more; the scenes' is dropped")
            }
        }
    }
}

fn time(integration_time_us: Option<f64>) -> String {
    integration_time_us.map_or_else(|| "time unknown".to_owned(), |time| format!("{time} µs"))
}

/// A decay with fewer positions follows its noise.
const ENOUGH_POSITIONS: usize = 8;

pub(super) fn about_decays(decays: &[Decay], uses: &[DecayUse]) -> Vec<FitWarning> {
    let mut warnings = Vec::new();
    for (decay, used) in decays.iter().zip(uses) {
        let integration_time_us = decay.integration_time_us;
        if used.scaling == Scaling::LeftOut {
            warnings.push(FitWarning::NoOverlap { integration_time_us });
        } else if decay.points.len() < ENOUGH_POSITIONS {
            warnings.push(FitWarning::TooFewDistances { integration_time_us, found: decay.points.len() });
        }
    }
    warnings
}

/// A decay with more outliers than this share says something else than the others.
const MANY_OUTLIERS: f64 = 1.0 / 3.0;

pub(super) fn about_outliers(decays: &[Decay], uses: &[SplineUse]) -> Vec<FitWarning> {
    let many = |(decay, used): &(&Decay, &SplineUse)| {
        used.outliers as f64 > MANY_OUTLIERS * decay.points.len() as f64
    };
    let warning = |(decay, used): (&Decay, &SplineUse)| FitWarning::Outliers {
        integration_time_us: decay.integration_time_us,
        outliers: used.outliers,
        positions: decay.points.len(),
    };
    decays.iter().zip(uses).filter(many).map(warning).collect()
}
