//! From exponents and their intervals to findings.

use super::diagnosis::Diagnosis;
use super::effect::{Effect, Estimate, Evidence, State};
use super::finding::Finding;
use super::material::Material;
use super::scaling::Scaling;
use super::still::StillPixels;

/// A gamma within this of 1 is linear, whatever its interval.
const LINEAR_GAMMA: f64 = 0.02;
/// ln(amplitude / eq. 1) that scatters by more than this around its fit, robust, is no function of the phase samples.
/// Both come from the same samples, so their noise cancels and only rounding is left: a step of 1 DN is 1.4 % of
/// 20 DN (1/√12). 5 % leaves room for faint images in coarse steps.
const EXPLAINED: f64 = 0.05;
/// An exponent that falls by more than this with the amplitude, beyond both intervals, bends.
const BEND: f64 = 0.1;

/// Exponents of d that differ by more than this between ranges are no power.
const CURVE: f64 = 0.7;

/// All findings that follow from the diagnosis.
pub(super) fn findings(diagnosis: &Diagnosis) -> Vec<Finding> {
    let mut findings = Vec::new();
    // Frames that are not comparable make every other finding doubtful. A stretch explains the factor.
    let stretched = diagnosis.scaled_by_frame.map(Finding::ScaledByFrame);
    findings.extend(stretched.or(diagnosis.exposure_changed.map(Finding::ExposureChanged)));
    let gamma = diagnosis.phase_samples.as_ref().ok().and_then(gamma_by_phase_samples);
    let distance = diagnosis.distance.as_ref().ok();
    findings.extend(gamma.clone());
    if gamma.is_none() {
        findings.extend(diagnosis.phase_samples.as_ref().ok().and_then(equals_phase_samples));
    }
    let compressed = diagnosis.still_pixels.as_ref().ok().and_then(compressed);
    findings.extend(diagnosis.time.as_ref().ok().and_then(|time| match &compressed {
        // Where the exponent bends, that of the low amplitudes decides.
        Some(bend) => time_below(bend),
        None => of_time(time, distance, gamma.is_some()),
    }));
    let explained =
        gamma.is_some() || findings.iter().any(|finding| matches!(finding, Finding::Gamma { .. }));
    let curve = distance.and_then(|distance| distance_curve(distance, &diagnosis.material));
    findings.extend(curve.or_else(|| distance.and_then(|distance| of_distance(distance, explained))));
    findings.extend(compressed);
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
    let gamma = scaling.gamma.filter(|_| scaling.residual < EXPLAINED)?;
    let bent = (gamma.value - 1.0).abs() > LINEAR_GAMMA && !gamma.reaches(1.0, 1.0);
    bent.then_some(Finding::Gamma { gamma: gamma.value, from_phase_samples: true })
}

/// `None` unless every interval is narrow enough. A quantity that did not vary cannot have been corrected for
/// differently from pixel to pixel.
pub(super) fn equals_phase_samples(scaling: &Scaling) -> Option<Finding> {
    let gamma = scaling.gamma.filter(|_| scaling.residual < EXPLAINED)?;
    let near =
        |estimate: Estimate, centre: f64| estimate.lies_within(centre - LINEAR_GAMMA, centre + LINEAR_GAMMA);
    let free = [&scaling.time, &scaling.distance]
        .iter()
        .all(|exponent| exponent.as_ref().map_or(true, |exponent| near(*exponent, 0.0)));
    let even = scaling.radial.as_ref().map_or(true, |radial| near(radial.corner_factor, 1.0));
    (near(gamma, 1.0) && free && even).then_some(Finding::EqualsPhaseSamples)
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
        State::Present => Some(Finding::DistanceRaw { exponent, evidence }),
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

/// Raw in time, where the exponent is 1 before it bends; a curve that bends everywhere is neither.
fn time_below(bend: &Finding) -> Option<Finding> {
    let Finding::Compressed { low_exponent, .. } = bend else { return None };
    ((low_exponent - 1.0).abs() <= BEND).then_some(Finding::TimeRaw)
}
