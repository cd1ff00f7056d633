//! Phases that are read in the wrong order or with the wrong sign. No camera's manual tells them; physics does:
//!
//! - opposite bins sum up to the same, whatever the scene ([`pairs`]);
//! - phases give the recorded distances, where there are some ([`recorded`]);
//! - the amplitude falls as d⁻², roughly, in any scene ([`law`]).
//!
//! Each way to read the bins is a [`Turn`]. One is named only where the one that is stated contradicts physics and
//! exactly one other fits. A wall at one distance tells nothing about the sign, and nothing is said of it.

mod evidence;
mod law;
mod pairs;
mod recorded;
mod sample;
#[cfg(test)]
mod tests;
mod turn;

pub use evidence::{PhaseEvidence, PhaseFault};
use law::Laws;
use sample::Pixel;
pub(super) use sample::Sample;
use turn::{Pairs, Turn};

use super::claims::Claims;

impl Sample {
    /// The bins of the pixels as they are read, DN.
    pub(super) fn bins(&self) -> impl Iterator<Item = [f32; 4]> {
        self.pixels.iter().map(|pixel| pixel.bins)
    }

    /// The way to read the phases that fits, where the stated one does not.
    pub(super) fn fault(&self, claims: &Claims) -> Option<PhaseFault> {
        let pixels = unclipped(&self.pixels);
        let (turn, evidence) = match pairs::misread(&pixels) {
            Some(opposites) => {
                let told = told(&pixels, opposites.pairs, claims);
                let turn = Turn { pairs: opposites.pairs, ..Turn::STATED };
                let (stated, found, sign_known) = (opposites.stated, opposites.found, told.is_some());
                (told.unwrap_or(turn), PhaseEvidence::Sums { stated, found, sign_known })
            }
            None => misread_phase(&pixels, claims)?,
        };
        let stated = claims.phase_convention;
        Some(PhaseFault { stated, fitting: turn.convention(stated), evidence })
    }
}

/// Pixels without a bin that may be clipped, whose amplitude and phase would be wrong.
fn unclipped(pixels: &[Pixel]) -> Vec<Pixel> {
    let bins = || pixels.iter().flat_map(|pixel| pixel.bins);
    let (least, most) = (bins().fold(f32::INFINITY, f32::min), bins().fold(f32::NEG_INFINITY, f32::max));
    let within = |pixel: &&Pixel| pixel.bins.iter().all(|&bin| bin > least && bin < most);
    pixels.iter().filter(within).copied().collect()
}

/// Start and sign of the phase of bins of which these are opposite, where something tells them.
fn told(pixels: &[Pixel], pairs: Pairs, claims: &Claims) -> Option<Turn> {
    let by_distance = |frequency_hz| recorded::agreement(pixels, pairs, frequency_hz);
    if let Some(agreement) = claims.modulation_frequency_hz.and_then(by_distance) {
        return Some(agreement.turn);
    }
    if claims.unwrapped_range_m.is_some() {
        return None;
    }
    Laws::of(pixels, pairs, Turn::all(pairs))?.only().map(|law| law.turn)
}

/// Another start or sign of the phase than the stated one, where that one contradicts recorded distances or the law.
fn misread_phase(pixels: &[Pixel], claims: &Claims) -> Option<(Turn, PhaseEvidence)> {
    let by_distance = |frequency_hz| recorded::agreement(pixels, Pairs::STATED, frequency_hz);
    if let Some(agreement) = claims.modulation_frequency_hz.and_then(by_distance) {
        let recorded::Agreement { turn, stated_m, found_m } = agreement;
        let evidence = PhaseEvidence::RecordedDistance { stated_m, found_m };
        return (turn != Turn::STATED).then_some((turn, evidence));
    }
    if !claims.distance_from_phases {
        return None;
    }
    // Of a phase that is no longer that of four bins, nothing but the sign can be changed.
    let sign_only = claims.unwrapped_range_m.is_some();
    let turns = Turn::all(Pairs::STATED).filter(|turn| !sign_only || turn.quarters == 0);
    let laws = Laws::of(pixels, Pairs::STATED, turns)?;
    let (stated, found) = laws.contradiction()?;
    Some((found.turn, PhaseEvidence::Law { stated: stated.exponent, found: found.exponent }))
}
