//! What the exponents mean, in words.

use std::fmt;

use serde::Serialize;

use super::diagnosis::Diagnosis;
use super::effect::{Effect, Estimate, Evidence, State};
use super::material::Material;
use super::panel::StillPixels;
use super::scaling::Scaling;
use super::vendor::VendorFinding;

/// A gamma within this of 1 is linear, whatever its interval.
const LINEAR_GAMMA: f64 = 0.02;
/// An exponent that falls by more than this with the amplitude, beyond both intervals, bends.
const BEND: f64 = 0.1;

/// Exponents of d that differ by more than this between ranges are no power.
const CURVE: f64 = 0.7;

/// One statement about the stream; its text is a sentence for a person.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "finding", rename_all = "snake_case")]
#[non_exhaustive]
pub enum Finding {
    /// t¹ is in it.
    TimeRaw,
    /// t is out of it.
    TimeCorrected,
    /// Part of t is left: corrected in part, or a gamma curve; what distance says cannot decide.
    TimePartly {
        /// What is left, the exponent.
        exponent: f64,
    },
    /// More than t¹, or less than t⁰.
    TimeOdd {
        /// The exponent.
        exponent: f64,
    },
    /// d⁻² is in it.
    DistanceRaw {
        /// Whose word it is that the material is one.
        evidence: Evidence,
    },
    /// d is out of it.
    DistanceCorrected {
        /// Whose word it is that the material is one.
        evidence: Evidence,
    },
    /// Part of d is left.
    DistancePartly {
        /// What is left, the exponent.
        exponent: f64,
        /// Whose word it is that the material is one.
        evidence: Evidence,
    },
    /// The exponent of d changes with the range: no power.
    DistanceCurve {
        /// The average exponent.
        exponent: f64,
        /// Smallest exponent of a third of the pixels.
        lowest: f64,
        /// Largest.
        highest: f64,
        /// What the average alone would say.
        state: State,
        /// Whose word it is that the material is one.
        evidence: Evidence,
    },
    /// Steeper than d⁻², or rising.
    DistanceOdd {
        /// The exponent.
        exponent: f64,
    },
    /// A power curve was applied.
    Gamma {
        /// Its exponent.
        gamma: f64,
        /// The evidence: phase samples, or exponents of t and d that shrink alike.
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
    /// Values pile up at the top.
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
}

/// Everything that the diagnosis allows to say.
pub(super) fn all(diagnosis: &Diagnosis) -> Vec<Finding> {
    let mut findings = Vec::new();
    let gamma = diagnosis.phase_samples.as_ref().ok().and_then(gamma_by_phase_samples);
    let distance = diagnosis.distance.as_ref().ok();
    findings.extend(gamma.clone());
    if gamma.is_none() {
        findings.extend(diagnosis.phase_samples.as_ref().ok().and_then(equals_phase_samples));
    }
    findings.extend(diagnosis.time.as_ref().ok().and_then(|time| of_time(time, distance, gamma.is_some())));
    let explained =
        gamma.is_some() || findings.iter().any(|finding| matches!(finding, Finding::Gamma { .. }));
    let curve = distance.and_then(|distance| distance_curve(distance, &diagnosis.material));
    findings.extend(curve.or_else(|| distance.and_then(|distance| of_distance(distance, explained))));
    findings.extend(diagnosis.still_pixels.as_ref().ok().and_then(compressed));
    if let Some(values) = &diagnosis.values {
        let (clip, saturated) = (values.pile_up, values.saturated_fraction);
        findings.extend(clip.map(|c| Finding::Clipped { value_dn: c.value_dn, fraction: c.fraction }));
        findings.extend((saturated > 0.0).then_some(Finding::Saturated { fraction: saturated }));
        findings.extend(values.levels.map(|levels| Finding::Coarse { levels }));
    }
    findings.extend(diagnosis.vendor_scaling.as_ref().ok().map(|scaling| Finding::Vendor(scaling.into())));
    findings
}

fn gamma_by_phase_samples(scaling: &Scaling) -> Option<Finding> {
    let gamma = scaling.gamma?;
    let bent = (gamma.value - 1.0).abs() > LINEAR_GAMMA && !gamma.reaches(1.0, 1.0);
    bent.then_some(Finding::Gamma { gamma: gamma.value, from_phase_samples: true })
}

fn equals_phase_samples(scaling: &Scaling) -> Option<Finding> {
    let absent = |exponent: &Estimate| exponent.value.abs() < LINEAR_GAMMA || exponent.reaches(0.0, 0.0);
    let even = scaling
        .radial
        .as_ref()
        .map_or(true, |radial| (radial.corner_factor.value - 1.0).abs() < LINEAR_GAMMA);
    let free = [&scaling.time, &scaling.distance].iter().all(|o| o.as_ref().map_or(true, absent));
    (free && even).then_some(Finding::EqualsPhaseSamples)
}

fn of_time(time: &Effect, distance: Option<&Effect>, gamma_known: bool) -> Option<Finding> {
    let exponent = time.exponent.value;
    match time.state {
        State::Present => Some(Finding::TimeRaw),
        State::Removed => Some(Finding::TimeCorrected),
        State::Reduced if gamma_known => None,
        State::Reduced => Some(match distance {
            // A power curve shrinks t¹ and d⁻² alike.
            Some(d) if d.state == State::Reduced && alike(time.exponent, d.exponent.divided_by(-2.0)) => {
                Finding::Gamma { gamma: exponent, from_phase_samples: false }
            }
            _ => Finding::TimePartly { exponent },
        }),
        State::Exaggerated | State::Reversed => Some(Finding::TimeOdd { exponent }),
        State::Undetermined => None,
    }
}

/// True when the two intervals overlap, or the values differ by no more than angle and gloss bend d⁻².
fn alike(first: Estimate, second: Estimate) -> bool {
    first.reaches(second.low_95, second.high_95) || (first.value / second.value - 1.0).abs() < 0.175
}

fn of_distance(distance: &Effect, gamma_known: bool) -> Option<Finding> {
    let (exponent, evidence) = (distance.exponent.value, distance.evidence);
    match distance.state {
        State::Present => Some(Finding::DistanceRaw { evidence }),
        State::Removed => Some(Finding::DistanceCorrected { evidence }),
        State::Reduced => (!gamma_known).then_some(Finding::DistancePartly { exponent, evidence }),
        State::Exaggerated | State::Reversed => Some(Finding::DistanceOdd { exponent }),
        State::Undetermined => None,
    }
}

/// Thirds of the pixels whose exponents differ by more than a third of d⁻², beyond their intervals.
fn distance_curve(distance: &Effect, material: &Material) -> Option<Finding> {
    let fit = match distance.evidence {
        Evidence::Target { .. } => material.best_target()?,
        Evidence::VendorReflectivity => material.vendor_reflectivity.as_ref().ok()?,
        Evidence::StillPixels => return None,
    };
    let exponents = || fit.by_distance.iter().map(|range| range.exponent);
    let lowest = exponents().min_by(|a, b| a.value.total_cmp(&b.value))?;
    let highest = exponents().max_by(|a, b| a.value.total_cmp(&b.value))?;
    let bends = highest.value - lowest.value > CURVE && highest.low_95 > lowest.high_95;
    bends.then_some(Finding::DistanceCurve {
        exponent: distance.exponent.value,
        lowest: lowest.value,
        highest: highest.value,
        state: distance.state,
        evidence: distance.evidence,
    })
}

fn compressed(still: &StillPixels) -> Option<Finding> {
    let (high, lower) = still.bands.split_last()?;
    let low = lower.iter().max_by(|a, b| a.exponent.value.total_cmp(&b.exponent.value))?;
    let falls = high.exponent.high_95 < low.exponent.low_95 - BEND && low.exponent.value > BEND;
    falls.then_some(Finding::Compressed {
        low_amplitude_dn: low.amplitude_dn,
        low_exponent: low.exponent.value,
        high_amplitude_dn: high.amplitude_dn,
        high_exponent: high.exponent.value,
    })
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
    /// True for what says whether the amplitude is raw or corrected; not for what else is known of it.
    fn is_about_corrections(&self) -> bool {
        !matches!(
            self,
            Self::Clipped { .. }
                | Self::Saturated { .. }
                | Self::Coarse { .. }
                | Self::Compressed { .. }
                | Self::Vendor(_)
        )
    }

    /// A few words, for those that the headline does not say otherwise.
    fn short(&self) -> Option<String> {
        Some(match self {
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
        })
    }
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
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
            Self::DistanceRaw { evidence } => {
                write!(
                    f,
                    "The amplitude of {evidence} falls with distance about as d^-2: not corrected for it."
                )
            }
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
