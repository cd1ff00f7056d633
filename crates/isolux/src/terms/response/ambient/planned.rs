//! The tier prepared for many pixels: the inverse as tables over amplitude, charge and phase.

use super::light::{Light, Well};
use super::model::{AmbientResponse, LARGEST_SHARE, phase};
use crate::terms::DistanceTable;

/// What is known of a delivered amplitude.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Recovered {
    /// The linear amplitude, DN.
    Linear(f32),
    /// It is too near to the largest amplitude that such a pixel can deliver, or beyond it.
    Saturated,
    /// A brighter surface that saturates would deliver it, too.
    Ambiguous,
}

/// The brightest surface that is expected, over the target of the calibration. A white target reflects 0.8 to 0.95.
const BRIGHTEST: f64 = 1.2;
/// Nodes over the amplitude. Below 0.97 of the peak, linear interpolation errs by less than 1e-4: the factor behaves like
/// `−κ √(1 − u)` there, κ < 1.
const SHARES: usize = 257;
/// Nodes over the linear amplitude beyond the peak, in units of the peak's, up to [`FARTHEST`].
const BEYOND: usize = 65;
/// Beyond this multiple of the peak's linear amplitude, all bins have clipped.
const FARTHEST: f64 = 5.0;
/// Nodes in an octave of the charge, and octaves from 1/2 on.
const CHARGES_PER_OCTAVE: usize = 8;
const OCTAVES: usize = 12;
/// The ripple over the phase has the period π/2 and hardly any harmonics: nodes at cos 4φ = 1, 0, −1.
const RIPPLES: usize = 3;
/// Points at which the amplitude is computed up to the peak.
const RISING: usize = 400;

#[derive(Clone, Debug, PartialEq)]
pub(crate) struct PlannedAmbient {
    /// Charge of the camera's own light over the amplitude, by the distance.
    own_charge: DistanceTable,
    /// µs per DN of the target, by the distance.
    target_us_per_dn: DistanceTable,
    /// (1 − cos 4φ) / 2, by the distance.
    ripple: DistanceTable,
    inverse: Vec<Inverse>,
}

/// The inverse at one charge and phase.
#[derive(Clone, Debug, PartialEq)]
struct Inverse {
    /// The largest amplitude, DN, and the linear one that gives it.
    peak_dn: f32,
    linear_at_peak_dn: f32,
    /// Linear over delivered amplitude, by the share of the peak.
    factor: Vec<f32>,
    /// Least amplitude from the peak on, over the peak's, by the linear amplitude over the peak's.
    falling: Vec<f32>,
}

impl Inverse {
    fn new(well: Well, charge: f64, phase: f64) -> Self {
        let peak = well.peak_dn(charge, phase);
        let kept = |a: f64| well.amplitude_dn(Light { amplitude_dn: a, charge, phase });
        let peak_dn = kept(peak);
        // Share of the peak, and factor, of rising linear amplitudes; the largest share is exactly 1.
        let rising: Vec<[f64; 2]> = (1..=RISING)
            .map(|i| peak * i as f64 / RISING as f64)
            .map(|a| [kept(a) / peak_dn, a / kept(a)])
            .collect();
        let mut next = 0;
        let factor = (0..SHARES).map(|node| {
            let share = node as f64 / (SHARES - 1) as f64;
            while next + 1 < rising.len() && rising[next][0] < share {
                next += 1;
            }
            let [high, factor] = rising[next];
            match next.checked_sub(1).map(|before| rising[before]) {
                Some([low, before]) => before + (factor - before) * ((share - low) / (high - low)).min(1.0),
                // Linear below the first point, as f is.
                None => 1.0 + (factor - 1.0) * share / high,
            }
        });
        let factor = factor.map(|factor| factor as f32).collect();
        let mut least = 1.0f64;
        let falling = (0..BEYOND).map(|node| {
            let times = 1.0 + (FARTHEST - 1.0) * node as f64 / (BEYOND - 1) as f64;
            least = least.min(kept(peak * times) / peak_dn);
            least as f32
        });
        let falling = falling.collect();
        Self { peak_dn: peak_dn as f32, linear_at_peak_dn: peak as f32, factor, falling }
    }
}

impl AmbientResponse {
    /// Prepared for many pixels.
    pub(crate) fn planned(&self) -> PlannedAmbient {
        let well = self.well();
        let nodes = 0..=CHARGES_PER_OCTAVE * OCTAVES;
        let phases = [0.0, 0.5, 1.0].map(|half_turn: f64| 0.25 * std::f64::consts::PI * half_turn);
        let inverse = nodes
            .flat_map(|node| phases.map(|phase| (charge_at(node), phase)))
            .map(|(charge, phase)| Inverse::new(well, charge, phase));
        PlannedAmbient {
            own_charge: self.table(|d| self.charge(d, 0.0)),
            target_us_per_dn: self.table(|d| 1.0 / self.target_at(d)),
            ripple: self.table(|d| 0.5 - 0.5 * (4.0 * phase(self.modulation_frequency_hz, d)).cos()),
            inverse: inverse.collect(),
        }
    }
}

/// Charge of a node: octaves from 1/2 on, divided evenly.
fn charge_at(node: usize) -> f64 {
    let octave = (node / CHARGES_PER_OCTAVE) as i32;
    0.5 * 2f64.powi(octave) * (1.0 + (node % CHARGES_PER_OCTAVE) as f64 / CHARGES_PER_OCTAVE as f64)
}

/// Node below a value, and the place 0..1 between it and the next, from the bits of a float.
#[inline(always)]
fn charge_node(charge: f32) -> (usize, f32) {
    const SHIFT: u32 = 23 - CHARGES_PER_OCTAVE.trailing_zeros();
    let last = f32::from_bits(((126 + OCTAVES as u32) << 23) - 1);
    let bits = charge.max(0.5).min(last).to_bits();
    let node = (bits >> SHIFT) as usize - ((126usize) << CHARGES_PER_OCTAVE.trailing_zeros());
    let place = (bits & ((1 << SHIFT) - 1)) as f32 * (1.0 / (1u32 << SHIFT) as f32);
    (node, place)
}

impl PlannedAmbient {
    /// What a pixel at this distance (m) and integration time (µs) tells, with the ambient light `ambient_dn_per_us` on
    /// the target of the calibration. A distance that is not positive has no answer.
    #[inline]
    pub(crate) fn linearise(
        &self,
        amplitude_dn: f32,
        distance_m: f32,
        time_us: f32,
        ambient_dn_per_us: f32,
    ) -> Option<Recovered> {
        if !(distance_m > 0.0 && distance_m < f32::INFINITY && amplitude_dn > 0.0 && time_us > 0.0) {
            return None;
        }
        let us_per_dn = self.target_us_per_dn.at(distance_m);
        let charge = self.own_charge.at(distance_m) + ambient_dn_per_us * us_per_dn;
        let at = self.place(charge, self.ripple.at(distance_m));
        let share = amplitude_dn / at.mix(|inverse| inverse.peak_dn);
        if share.is_nan() || share > LARGEST_SHARE as f32 {
            return Some(Recovered::Saturated);
        }
        let brightest = time_us * BRIGHTEST as f32 / us_per_dn;
        let times = brightest / at.mix(|inverse| inverse.linear_at_peak_dn);
        if times > 1.0 {
            let (node, place) = node(times - 1.0, (FARTHEST - 1.0) as f32, BEYOND);
            let least = at.mix(|inverse| between(&inverse.falling, node, place));
            if share >= LARGEST_SHARE as f32 * least {
                return Some(Recovered::Ambiguous);
            }
        }
        let (node, place) = node(share, 1.0, SHARES);
        Some(Recovered::Linear(amplitude_dn * at.mix(|inverse| between(&inverse.factor, node, place))))
    }

    #[inline(always)]
    fn place(&self, charge: f32, ripple: f32) -> Place<'_> {
        let (node, along) = charge_node(charge);
        let across = (ripple.max(0.0) * (RIPPLES - 1) as f32).min((RIPPLES - 1) as f32 - 1e-4);
        let column = across as usize;
        let corner = |node: usize, column: usize| &self.inverse[node * RIPPLES + column];
        Place {
            corners: [
                corner(node, column),
                corner(node, column + 1),
                corner(node + 1, column),
                corner(node + 1, column + 1),
            ],
            along,
            across: across - column as f32,
        }
    }
}

/// Between four nodes of charge and phase.
struct Place<'a> {
    corners: [&'a Inverse; 4],
    along: f32,
    across: f32,
}

impl Place<'_> {
    #[inline(always)]
    fn mix(&self, value: impl Fn(&Inverse) -> f32) -> f32 {
        let [a, b, c, d] = self.corners.map(value);
        let (near, far) = (a + (b - a) * self.across, c + (d - c) * self.across);
        near + (far - near) * self.along
    }
}

/// Node below a value of 0..=`largest` and the place 0..=1 after it, of `nodes` in equal steps.
#[inline(always)]
fn node(value: f32, largest: f32, nodes: usize) -> (usize, f32) {
    let position = (value / largest * (nodes - 1) as f32).min((nodes - 1) as f32);
    let node = (position as usize).min(nodes - 2);
    (node, position - node as f32)
}

#[inline(always)]
fn between(values: &[f32], node: usize, place: f32) -> f32 {
    values[node] + (values[node + 1] - values[node]) * place
}
