//! The findings of a diagnosis, and their sentences.

use std::fmt;

use serde::Serialize;

use super::effect::{Evidence, State};
use super::vendor::VendorFinding;
use crate::advice::Advice;
use crate::common_factor::{ExposureCourse, SpannedFrames};
use crate::inspect::Suspicion;

/// Exponents of d that are called "about -2".
const ABOUT: f64 = 0.1;

/// One statement about the recording; [`Display`](fmt::Display) gives a sentence.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "finding", rename_all = "snake_case")]
#[non_exhaustive]
pub enum Finding {
    /// Frames were scaled one by one: they are not comparable.
    ScaledByFrame(SpannedFrames),
    /// All still pixels share a factor from frame to frame that no recorded time explains.
    ExposureChanged(ExposureCourse),
    /// The amplitude grows with t¹: not corrected for the integration time.
    TimeRaw,
    /// The amplitude does not depend on t: corrected for the integration time.
    TimeCorrected,
    /// The amplitude grows with less than t¹: corrected in part, or a gamma curve. The exponent of the distance
    /// does not decide which.
    TimePartly {
        /// The exponent.
        exponent: f64,
    },
    /// The amplitude grows faster than t¹, or falls with t.
    TimeOdd {
        /// The exponent.
        exponent: f64,
    },
    /// The amplitude falls with d⁻²: not corrected for the distance.
    DistanceRaw {
        /// The exponent.
        exponent: f64,
        /// What shows that all compared pixels are of one material.
        evidence: Evidence,
    },
    /// The amplitude does not depend on d: the distance has been corrected for.
    DistanceCorrected {
        /// What shows that all compared pixels are of one material.
        evidence: Evidence,
    },
    /// The amplitude falls with less than d⁻²: corrected in part, or a gamma curve.
    DistancePartly {
        /// The exponent.
        exponent: f64,
        /// What shows that all compared pixels are of one material.
        evidence: Evidence,
    },
    /// The exponent of d changes with the range: the law is not a power.
    DistanceCurve {
        /// The average exponent.
        exponent: f64,
        /// Smallest exponent of the thirds of the pixels.
        lowest: f64,
        /// Largest exponent of the thirds.
        highest: f64,
        /// The state that the average exponent alone would give.
        state: State,
        /// What shows that all compared pixels are of one material.
        evidence: Evidence,
    },
    /// The amplitude falls faster than d⁻², or grows with d.
    DistanceOdd {
        /// The exponent.
        exponent: f64,
    },
    /// A power curve was applied.
    Gamma {
        /// Its exponent.
        gamma: f64,
        /// True when the phase samples show it; false when the exponents of t and d are reduced alike.
        from_phase_samples: bool,
    },
    /// The amplitude is eq. 1 of its phase samples, times a constant.
    EqualsPhaseSamples,
    /// The exponent of t falls as the amplitude grows.
    Compressed {
        /// Amplitude below which the exponent is `low_exponent`, DN.
        low_amplitude_dn: f64,
        /// Exponent of t there.
        low_exponent: f64,
        /// Amplitude around which the exponent is `high_exponent`, DN.
        high_amplitude_dn: f64,
        /// Exponent of t there.
        high_exponent: f64,
    },
    /// Many pixels have exactly the largest value.
    Clipped {
        /// The value, DN.
        value_dn: f64,
        /// Valid pixels at it, 0..=1.
        fraction: f64,
    },
    /// Pixels carry the saturation code.
    Saturated {
        /// Share of the pixels, 0..=1.
        fraction: f64,
    },
    /// What the vendor does to the amplitude.
    Vendor(VendorFinding),
    /// Few different values.
    Coarse {
        /// How many.
        levels: usize,
    },
    /// Something about the recording is probably not as it says.
    Suspicion(Suspicion),
}

/// The findings in a few words.
pub(super) fn headline(findings: &[Finding]) -> String {
    let has = |wanted: fn(&Finding) -> bool| findings.iter().any(wanted);
    let (time_raw, time_corrected) = (has(|f| *f == Finding::TimeRaw), has(|f| *f == Finding::TimeCorrected));
    let distance_raw = has(|f| matches!(f, Finding::DistanceRaw { .. }));
    let distance_corrected = has(|f| matches!(f, Finding::DistanceCorrected { .. }));
    let mut words: Vec<String> = Vec::new();
    let pair = |time: bool, distance: bool| match (time, distance) {
        (true, true) => Some("integration time and distance"),
        (true, false) => Some("integration time"),
        (false, true) => Some("distance"),
        (false, false) => None,
    };
    words.extend(pair(time_raw, distance_raw).map(|what| format!("raw in {what}")));
    words
        .extend(pair(time_corrected, distance_corrected).map(|what| format!("already corrected for {what}")));
    let corrections = |finding: &&Finding| finding.is_about_corrections();
    words.extend(findings.iter().filter(corrections).filter_map(Finding::short));
    if words.is_empty() {
        words.push("raw or corrected: cannot be told".to_owned());
    }
    words.extend(findings.iter().filter(|finding| !corrections(finding)).filter_map(Finding::short));
    words.join("; ")
}

impl Finding {
    /// True for a finding about whether the amplitude is raw or corrected.
    fn is_about_corrections(&self) -> bool {
        !matches!(
            self,
            Self::ScaledByFrame(_)
                | Self::ExposureChanged(_)
                | Self::Clipped { .. }
                | Self::Saturated { .. }
                | Self::Coarse { .. }
                | Self::Vendor(_)
                | Self::Suspicion(_)
        )
    }

    /// What can be done about it.
    #[must_use]
    pub fn advice(&self) -> Option<Advice> {
        match self {
            Self::Suspicion(suspicion) => suspicion.advice(),
            _ => None,
        }
    }

    /// A few words for the headline; `None` for findings that it states otherwise.
    fn short(&self) -> Option<String> {
        Some(match self {
            Self::ScaledByFrame(_) => "scaled frame by frame".to_owned(),
            Self::ExposureChanged(ExposureCourse { least, largest, .. }) => {
                format!("a common factor of {least:.2} to {largest:.2} from frame to frame")
            }
            Self::TimeRaw
            | Self::TimeCorrected
            | Self::DistanceRaw { .. }
            | Self::DistanceCorrected { .. } => {
                return None;
            }
            Self::TimePartly { exponent } => format!("t^{exponent:.2} left: partly corrected or gamma"),
            Self::TimeOdd { exponent } => format!("odd in integration time: t^{exponent:.2}"),
            Self::DistancePartly { exponent, .. } => {
                format!("d^{exponent:.2} left: partly corrected or gamma")
            }
            Self::DistanceCurve { exponent, .. } => {
                format!("distance: d^{exponent:.2} on average, but no single power")
            }
            Self::Vendor(vendor) => vendor.short(),
            Self::DistanceOdd { exponent } => format!("odd in distance: d^{exponent:.2}"),
            Self::Gamma { gamma, .. } => format!("gamma {gamma:.2} applied"),
            Self::EqualsPhaseSamples => "equal to its phase samples".to_owned(),
            Self::Compressed { .. } => "compressed at high amplitude".to_owned(),
            Self::Clipped { value_dn, .. } => format!("clipped at {value_dn}"),
            Self::Saturated { fraction } => format!("{:.1} % saturated", 100.0 * fraction),
            Self::Coarse { levels } => format!("only {levels} levels"),
            Self::Suspicion(suspicion) => suspicion.short().to_owned(),
        })
    }
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::ScaledByFrame(spanned) => {
                write!(f, "In this recording, {spanned}. Record the values as the camera delivers them.")
            }
            Self::ExposureChanged(course) => write!(f, "In this recording, {course}."),
            Self::TimeRaw => {
                write!(f, "The amplitude grows in proportion to the integration time: not corrected for it.")
            }
            Self::TimeCorrected => write!(
                f,
                "The amplitude does not change with the integration time: already corrected for it."
            ),
            Self::TimePartly { exponent } => write!(
                f,
                "The amplitude grows with t^{exponent:.2}, less than in proportion: corrected in part, or a curve such as \
                 a gamma of {exponent:.2}. A labelled target at several distances would tell: a gamma shrinks the exponent \
                 of distance alike."
            ),
            Self::TimeOdd { exponent } => write!(
                f,
                "The amplitude goes with t^{exponent:.2}, which no sensor does: corrected too far, a curve, or integration \
                 times that are not those of the frames."
            ),
            Self::DistanceRaw { exponent, evidence } if (exponent + 2.0).abs() < ABOUT => {
                write!(
                    f,
                    "The amplitude of {evidence} falls with distance about as d^-2: not corrected for it."
                )
            }
            Self::DistanceRaw { exponent, evidence } => write!(
                f,
                "The amplitude of {evidence} falls as d^{exponent:.2}, not quite as d^-2: not corrected for distance; lights \
                 beside the lens, tilt and gloss bend the law."
            ),
            Self::DistanceCorrected { evidence } => {
                write!(
                    f,
                    "The amplitude of {evidence} hardly changes with distance: already corrected for it."
                )
            }
            Self::DistancePartly { exponent, evidence } => write!(
                f,
                "The amplitude of {evidence} goes with d^{exponent:.2}, between raw (-2) and corrected (0): corrected in \
                 part, a gamma curve, or a target that is glossy or turned away."
            ),
            Self::DistanceCurve { exponent, lowest, highest, state, evidence } => {
                let average = match state {
                    State::Present => ", about as raw",
                    State::Removed => ", nearly flat",
                    _ => "",
                };
                write!(
                    f,
                    "The amplitude of {evidence} goes with d^{exponent:.2} on average{average}, but with {lowest:.2} to \
                     {highest:.2} in parts of the range: no single power. A correction by d^2 would be wrong; fit a curve."
                )
            }
            Self::Vendor(vendor) => vendor.fmt(f),
            Self::Suspicion(suspicion) => suspicion.fmt(f),
            Self::DistanceOdd { exponent } => write!(
                f,
                "The amplitude goes with d^{exponent:.2}, which is neither raw (-2) nor corrected (0): corrected too far, a \
                 curve, or a target that is not one material."
            ),
            Self::Gamma { gamma, from_phase_samples: true } => {
                write!(
                    f,
                    "The amplitude is the power {gamma:.3} of what its phase samples give: a gamma curve was applied."
                )
            }
            Self::Gamma { gamma, from_phase_samples: false } => write!(
                f,
                "The exponents of integration time and distance are both {gamma:.2} of the physical ones: a gamma curve of \
                 {gamma:.2} was applied."
            ),
            Self::EqualsPhaseSamples => {
                write!(
                    f,
                    "The amplitude is what its phase samples give by eq. 1, times a constant: nothing was applied to it."
                )
            }
            Self::Compressed { low_amplitude_dn, low_exponent, high_amplitude_dn, high_exponent } => write!(
                f,
                "The exponent of integration time falls from {low_exponent:.2} near {low_amplitude_dn:.0} DN to \
                 {high_exponent:.2} near {high_amplitude_dn:.0} DN: saturation, or a curve that compresses."
            ),
            Self::Clipped { value_dn, fraction } => write!(
                f,
                "{:.2} % of the valid pixels have exactly the largest value, {value_dn} DN: clipped there. They are left out \
                 of the fits.",
                100.0 * fraction
            ),
            Self::Saturated { fraction } => {
                write!(
                    f,
                    "{:.2} % of the pixels are marked as saturated; they are left out of the fits.",
                    100.0 * fraction
                )
            }
            Self::Coarse { levels } => {
                write!(
                    f,
                    "The amplitude takes {levels} different values only: 8 bits or less. Dark pixels move in steps."
                )
            }
        }
    }
}

impl fmt::Display for Evidence {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::StillPixels => write!(f, "the same pixels"),
            Self::Target { label } => write!(f, "target {label}"),
            Self::VendorReflectivity => write!(f, "what the vendor reports as one reflectivity"),
        }
    }
}
