//! Does the amplitude fall with the distance as d⁻²?

use super::sample::Pixel;
use super::turn::{Pairs, Turn};
use crate::numerics::statistics::median;

/// Groups of pixels of like distance. Each has its median, so that what is bright or dark in a scene averages out.
const GROUPS: usize = 12;
/// Pixels below which nothing is told.
const FEWEST_PIXELS: usize = 200;
/// The farthest of the groups is so many times as far as the nearest ...
const LEAST_RANGE: f64 = 1.5;
/// ... and no step between groups is more than this share of that (of its logarithm): of two distances, any law fits.
const LARGEST_STEP: f64 = 0.5;
/// Exponents that scenes of correct recordings show: darker things are near or far, bright ones saturate, boards tilt.
/// The law of phases that are read the wrong way is far outside ...
const PLAUSIBLE: std::ops::Range<f64> = -3.6..1.5;
/// ... and leaves at least this misfit; where distances fold, there is no exponent, but the misfit is larger than this.
const IMPLAUSIBLE_MISFIT: f64 = 0.4;
const FOLDED_MISFIT: f64 = 1.5;
/// Exponents that a law of d⁻² shows in a scene, and its misfit there.
const FITTING: std::ops::Range<f64> = -3.0..-1.2;
const FITTING_MISFIT: f64 = 0.5;
/// The way that fits leaves less than this share of the misfit of the stated one.
const BETTER: f64 = 0.7;

/// How the amplitude goes with the distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Law {
    pub(super) turn: Turn,
    pub(super) exponent: f64,
    /// Root mean square of ln(amplitude · d²) over groups of like distance.
    misfit: f64,
    /// True where the distances are many enough to tell a law.
    told: bool,
}

/// Amplitude and phase of pixels by the law, for any way to read them.
#[derive(Clone, Debug)]
pub(super) struct Laws(Vec<Law>);

impl Laws {
    /// Tries all `turns`, ways to read bins of which these are opposite. `None` where the pixels are too few.
    pub(super) fn of(pixels: &[Pixel], pairs: Pairs, turns: impl Iterator<Item = Turn>) -> Option<Self> {
        // The imbalance of a pixel is noise of √4 times one bin; the amplitude has 1/√2 of a bin's.
        let mut noise: Vec<f64> = pixels.iter().map(|pixel| pairs.imbalance(pixel.bins).abs()).collect();
        let amplitude_noise = median(&mut noise)? / 0.6745 / 2.0 / 2f64.sqrt();
        let polar = pixels.iter().filter_map(|pixel| {
            let [cosine, sine] = pairs.differences(pixel.bins);
            let amplitude = 0.5 * cosine.hypot(sine);
            let bright = amplitude > 5.0 * amplitude_noise;
            let phase = pixel.phase.unwrap_or_else(|| sine.atan2(cosine));
            bright.then(|| (phase, (amplitude * pixel.per_time).ln()))
        });
        let polar: Vec<(f64, f64)> = polar.collect();
        (polar.len() >= FEWEST_PIXELS).then(|| Self(turns.filter_map(|turn| law(&polar, turn)).collect()))
    }

    /// The one way that fits, where exactly one does.
    pub(super) fn only(&self) -> Option<Law> {
        let fits = |law: &&Law| law.told && FITTING.contains(&law.exponent) && law.misfit < FITTING_MISFIT;
        let mut fitting = self.0.iter().filter(fits);
        let (first, second) = (fitting.next()?, fitting.next());
        second.is_none().then_some(*first)
    }

    /// The law of the phases as they are read and the one that fits, where no scene would show the first.
    pub(super) fn contradiction(&self) -> Option<(Law, Law)> {
        let stated = *self.0.iter().find(|law| law.turn == Turn::STATED)?;
        let outside = !PLAUSIBLE.contains(&stated.exponent) && stated.misfit > IMPLAUSIBLE_MISFIT;
        let found = self.only()?;
        let better = found.misfit < BETTER * stated.misfit;
        (better && (outside || stated.misfit > FOLDED_MISFIT)).then_some((stated, found))
    }
}

/// Groups pixels by their distance and looks how their medians fall.
fn law(polar: &[(f64, f64)], turn: Turn) -> Option<Law> {
    let mut points: Vec<(f64, f64)> = polar
        .iter()
        .map(|&(phase, ln_amplitude)| (turn.of(phase).max(f64::MIN_POSITIVE).ln(), ln_amplitude))
        .collect();
    points.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
    let group = points.len() / GROUPS;
    let mut groups = [(0.0, 0.0); GROUPS];
    for (found, points) in groups.iter_mut().zip(points.chunks_exact(group.max(1))) {
        let mut amplitudes: Vec<f64> = points.iter().map(|point| point.1).collect();
        *found = (points[points.len() / 2].0, median(&mut amplitudes)?);
    }
    let mut levels: Vec<f64> = groups.iter().map(|(x, y)| y + 2.0 * x).collect();
    let squares = levels.clone();
    let level = median(&mut levels)?;
    let sum: f64 = squares.iter().map(|value| (value - level).powi(2)).sum();
    let range = groups[GROUPS - 1].0 - groups[0].0;
    let step = groups.windows(2).map(|pair| pair[1].0 - pair[0].0).fold(0.0, f64::max);
    Some(Law {
        turn,
        exponent: exponent(&groups)?,
        misfit: (sum / GROUPS as f64).sqrt(),
        told: range > LEAST_RANGE.ln() && step < LARGEST_STEP * range,
    })
}

/// Median slope between groups.
fn exponent(groups: &[(f64, f64)]) -> Option<f64> {
    let pairs = groups.iter().enumerate().flat_map(|(at, a)| groups[at + 1..].iter().map(move |b| (a, b)));
    let slopes = pairs.filter(|(a, b)| b.0 > a.0).map(|(a, b)| (b.1 - a.1) / (b.0 - a.0));
    median(&mut slopes.collect::<Vec<_>>())
}
