//! Demodulation: amplitude (eq. 1 of Stürmer, Penne and Hornegger 2008) and radial distance from the four raw bins
//! A1..A4, DN.

use serde::{Deserialize, Serialize};

use super::{Plane, ShapeError};

/// Speed of light in vacuum, m/s (exact, SI).
pub const SPEED_OF_LIGHT_M_PER_S: f64 = 299_792_458.0;

/// Share of the clip level from which on a phase sample counts as clipped: read noise spreads the clip (methods,
/// section 2).
pub const CLIPPED_SHARE: f64 = 0.985;

/// Order and sign in which a vendor delivers the bins.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct PhaseConvention {
    /// `order[k]` is the position, in the recording, of the paper's bin A(k+1). A permutation of 0..4.
    pub order: [usize; 4],
    /// `true` where the phase has the opposite sign, φ → −φ.
    pub reversed: bool,
}

impl Default for PhaseConvention {
    fn default() -> Self {
        Self { order: [0, 1, 2, 3], reversed: false }
    }
}

impl PhaseConvention {
    /// True when `order` names each bin once.
    #[must_use]
    pub fn is_permutation(&self) -> bool {
        (0..4).all(|bin| self.order.contains(&bin))
    }

    /// Positions, in the recording, of bins that are the paper's A1..A4 in order and sign.
    #[must_use]
    pub fn positions(&self) -> [usize; 4] {
        let [a1, a2, a3, a4] = self.order;
        // The phase that runs the other way changes the sign of A2 − A4 and of nothing else.
        if self.reversed { [a1, a4, a3, a2] } else { self.order }
    }
}

/// Amplitude in the unit of the bins, eq. 1 of Stürmer, Penne and Hornegger (2008):
/// `a = ½ √((A1−A3)² + (A2−A4)²)`.
#[must_use]
pub fn amplitude(bins: [f32; 4]) -> f32 {
    let (cosine, sine) = (bins[0] - bins[2], bins[1] - bins[3]);
    0.5 * (cosine * cosine + sine * sine).sqrt()
}

/// Phase of a radial distance (m), not wrapped: `4π f d / c`, rad.
pub(crate) fn of_distance(modulation_frequency_hz: f64, distance_m: f64) -> f64 {
    4.0 * std::f64::consts::PI * modulation_frequency_hz * distance_m / SPEED_OF_LIGHT_M_PER_S
}

/// Distance of a phase of 1 rad, `c / 4π f`, m.
pub(crate) fn metres_per_radian(modulation_frequency_hz: f64) -> f64 {
    SPEED_OF_LIGHT_M_PER_S / (4.0 * std::f64::consts::PI * modulation_frequency_hz)
}

/// Radial distance in metres, `c φ / 4π f` with `φ = atan2(A2−A4, A1−A3) mod 2π`, in 0..`c/2f`.
#[must_use]
pub fn distance_m(bins: [f32; 4], modulation_frequency_hz: f64, reversed: bool) -> f32 {
    let (cosine, sine) = (f64::from(bins[0]) - f64::from(bins[2]), f64::from(bins[1]) - f64::from(bins[3]));
    let sine = if reversed { -sine } else { sine };
    let phase = sine.atan2(cosine).rem_euclid(std::f64::consts::TAU);
    (SPEED_OF_LIGHT_M_PER_S * phase / (4.0 * std::f64::consts::PI * modulation_frequency_hz)) as f32
}

/// Amplitude of every pixel, from bins in the paper's order, into `out`.
///
/// # Errors
/// [`ShapeError::Mismatch`] when the planes differ in shape.
pub fn amplitude_into(bins: &[Plane<f32>; 4], out: &mut Plane<f32>) -> Result<(), ShapeError> {
    map_bins(bins, out, amplitude)
}

/// Radial distance of every pixel in metres, from bins in the paper's order, into `out`; NaN where the bins
/// carry no modulation.
///
/// # Errors
/// [`ShapeError::Mismatch`] when the planes differ in shape.
pub fn distance_into(
    bins: &[Plane<f32>; 4],
    modulation_frequency_hz: f64,
    reversed: bool,
    out: &mut Plane<f32>,
) -> Result<(), ShapeError> {
    map_bins(bins, out, |bins| {
        if amplitude(bins) > 0.0 { distance_m(bins, modulation_frequency_hz, reversed) } else { f32::NAN }
    })
}

fn map_bins(
    bins: &[Plane<f32>; 4],
    out: &mut Plane<f32>,
    value: impl Fn([f32; 4]) -> f32,
) -> Result<(), ShapeError> {
    let shape = bins[0].shape();
    for bin in &bins[1..] {
        bin.expect_shape("phase_samples", shape)?;
    }
    out.reshape(shape, f32::NAN);
    let [a1, a2, a3, a4] = bins;
    let samples = a1.values().iter().zip(a2.values()).zip(a3.values()).zip(a4.values());
    for (out, (((&a1, &a2), &a3), &a4)) in out.values_mut().iter_mut().zip(samples) {
        *out = value([a1, a2, a3, a4]);
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bins(offset: f64, amplitude: f64, phase: f64) -> [f32; 4] {
        [0.0, 1.0, 2.0, 3.0]
            .map(|k| (offset + amplitude * (phase - k * std::f64::consts::FRAC_PI_2).cos()) as f32)
    }

    #[test]
    fn equation_1_gives_the_amplitude_of_the_cosine_for_every_phase() {
        for step in 0..32 {
            let phase = f64::from(step) * std::f64::consts::TAU / 32.0;
            let found = amplitude(bins(1000.0, 250.0, phase));
            // Bins near 1250 carry half an f32 ulp of 2^-14 each; four of them enter.
            assert!((found - 250.0).abs() < 4.0 / 8192.0, "{found}");
        }
    }

    #[test]
    fn distance_grows_with_phase_over_the_ambiguity_range() {
        let frequency = 20e6;
        let range = SPEED_OF_LIGHT_M_PER_S / (2.0 * frequency);
        for step in 1..16 {
            let fraction = f64::from(step) / 16.0;
            let bins = bins(500.0, 300.0, fraction * std::f64::consts::TAU);
            let forward = f64::from(distance_m(bins, frequency, false));
            let backward = f64::from(distance_m(bins, frequency, true));
            assert!((forward - fraction * range).abs() < 1e-5 * range);
            assert!((backward - (1.0 - fraction) * range).abs() < 1e-5 * range);
        }
    }

    #[test]
    fn equal_bins_have_no_distance() {
        let bins = [(); 4].map(|()| Plane::filled(crate::frame::Shape::new(1, 1), 40.0));
        let mut out = Plane::filled(bins[0].shape(), 0.0);
        distance_into(&bins, 20e6, false, &mut out).unwrap();
        assert!(out.values()[0].is_nan());
    }

    #[test]
    fn an_order_that_repeats_a_bin_is_no_permutation() {
        assert!(PhaseConvention::default().is_permutation());
        assert!(!PhaseConvention { order: [0, 1, 1, 3], reversed: false }.is_permutation());
    }
}
