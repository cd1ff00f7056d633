//! The parameters of the tier and what they say of a pixel.

use serde::{Deserialize, Serialize};

use super::light::{Light, Well};
use crate::frame::phase::of_distance;
use crate::terms::check::{Check, ParameterError, Parameters};
use crate::terms::response::well::SoftWell;
use crate::terms::spline::Law;
use crate::terms::{DistanceTable, FitQuality, Source};

/// Variance of an amplitude by the charge of its bins.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AmbientNoise {
    /// Read noise and quantization of the amplitude, DN².
    pub read_variance_dn2: f64,
    /// Shot noise of a bin, DN² per DN of charge.
    pub shot_variance_dn2_per_dn: f64,
}

/// The well as a distance sweep shows it, and the light that filled it there.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AmbientResponse {
    /// W: charge at which the linear law would fill the well, DN.
    pub full_well_dn: f64,
    /// Softness p of the well.
    pub softness: f64,
    /// Share of W at which a bin clips, 0.5 to 1.
    pub clip: f64,
    /// c0: charge of a bin's mean by the camera's own light, over the linear amplitude. Only W / c0 is measured.
    pub own_charge: f64,
    /// B: charge per µs that the ambient light of the sweep puts into a pixel that sees its target, DN/µs.
    pub ambient_dn_per_us: f64,
    /// K: linear amplitude per µs of the target at the reference distance, DN/µs.
    pub target_dn_per_us: f64,
    /// h, the target's amplitude over the distance.
    pub law: Law,
    /// Modulation frequency of the sweep, Hz, which gives the phase of a distance; a mean phase where it is unknown.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub modulation_frequency_hz: Option<f64>,
    /// Noise of the amplitude; absent where no position had repeated frames. The ambient light of another scene is then
    /// unknown.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub noise: Option<AmbientNoise>,
    /// The recordings that it was fitted to.
    pub fitted_on: Vec<Source>,
    /// How well it fits: relative error of the amplitudes of all positions and times.
    pub fit: FitQuality,
}

/// Phase of the mean of the 4φ ripple, for cameras of unknown frequency.
const MEAN_PHASE: f64 = std::f64::consts::FRAC_PI_8;
/// Amplitudes above this share of the peak are not inverted: their noise would grow without limit.
pub(super) const LARGEST_SHARE: f64 = 0.97;
/// The same for amplitudes that a law over distance is fitted to: errors of the model grow there, too.
const LARGEST_FITTED_SHARE: f64 = 0.9;
/// Where the kept amplitude rises by less than this share of the linear one, its peak is reached.
const LEAST_SLOPE: f64 = 0.02;
/// Tables over the distance reach beyond the fitted distances by this factor.
const REACH: f64 = 4.0;

/// Phase of a distance (m), rad.
pub(super) fn phase(modulation_frequency_hz: Option<f64>, distance_m: f64) -> f64 {
    modulation_frequency_hz.map_or(MEAN_PHASE, |frequency_hz| of_distance(frequency_hz, distance_m))
}

impl AmbientResponse {
    pub(super) fn well(&self) -> Well {
        Well { full_well_dn: self.full_well_dn, shape: SoftWell { softness: self.softness }, clip: self.clip }
    }

    /// Amplitude per µs of the target at a distance (m), DN/µs.
    pub(super) fn target_at(&self, distance_m: f64) -> f64 {
        self.target_dn_per_us * self.law.ln_response(distance_m).exp()
    }

    /// The same for many distances.
    pub(crate) fn target_table(&self) -> DistanceTable {
        self.table(|distance_m| self.target_at(distance_m))
    }

    /// A table over the fitted distances and far beyond.
    pub(super) fn table(&self, of: impl Fn(f64) -> f64) -> DistanceTable {
        let [min_m, max_m] = self.law.valid_distance_m;
        DistanceTable::coarse(of, (min_m / REACH).max(1e-4), max_m * REACH)
    }

    /// c at a distance (m), with the ambient light `ambient_dn_per_us` on the target of the calibration. The harmonic
    /// is in the amplitude but not in the charge.
    pub(super) fn charge(&self, distance_m: f64, ambient_dn_per_us: f64) -> f64 {
        let harmonic = self.law.harmonic.map_or(0.0, |harmonic| harmonic.at(distance_m));
        self.own_charge * (-harmonic).exp() + ambient_dn_per_us / self.target_at(distance_m)
    }

    /// The linear amplitude (DN) of a delivered one on the rising branch; `None` where it exceeds the peak.
    ///
    /// Newton's method from below: the kept amplitude is concave up to its peak, so that no step passes the solution.
    pub(super) fn linear_dn(&self, amplitude_dn: f64, charge: f64, phase: f64) -> Option<f64> {
        const STEPS: usize = 40;
        let well = self.well();
        let kept = |a: f64| well.amplitude_dn(Light { amplitude_dn: a, charge, phase });
        let mut linear_dn = amplitude_dn;
        for _ in 0..STEPS {
            let found = kept(linear_dn);
            let slope = (kept(linear_dn * (1.0 + 1e-5)) - found) / (1e-5 * linear_dn);
            if slope.is_nan() || slope < LEAST_SLOPE {
                return None;
            }
            let step = (amplitude_dn - found) / slope;
            linear_dn += step;
            if step.abs() < 1e-7 * linear_dn {
                return Some(linear_dn);
            }
        }
        None
    }

    /// The linear amplitude (DN) that the target of the sweep had where `amplitude_dn` was delivered, in the light of
    /// the sweep; `None` near the peak and above it.
    pub(crate) fn linear_of_sweep_dn(&self, amplitude_dn: f64, distance_m: f64) -> Option<f64> {
        let charge = self.charge(distance_m, self.ambient_dn_per_us);
        let phase = phase(self.modulation_frequency_hz, distance_m);
        let well = self.well();
        let peak = well.amplitude_dn(Light { amplitude_dn: well.peak_dn(charge, phase), charge, phase });
        if amplitude_dn > LARGEST_FITTED_SHARE * peak {
            return None;
        }
        self.linear_dn(amplitude_dn, charge, phase)
    }

    /// Variance (DN²) of an amplitude of a group of pixels at distances at which the target has the amplitude
    /// `target_dn_per_us` per µs; all phases are among them. Above the peak, that of the peak. `None` without noise.
    pub(crate) fn variance_dn2(
        &self,
        amplitude_dn: f64,
        target_dn_per_us: f64,
        ambient_dn_per_us: f64,
    ) -> Option<f64> {
        let AmbientNoise { read_variance_dn2, shot_variance_dn2_per_dn } = self.noise?;
        let charge = self.own_charge + ambient_dn_per_us / target_dn_per_us;
        let rising = self.linear_dn(amplitude_dn, charge, MEAN_PHASE);
        let amplitude_dn = rising.unwrap_or_else(|| self.well().peak_dn(charge, MEAN_PHASE));
        let light = Light { amplitude_dn, charge, phase: MEAN_PHASE };
        Some(self.well().variance_dn2(light, read_variance_dn2, shot_variance_dn2_per_dn))
    }
}

impl Parameters for AmbientResponse {
    const NAME: &'static str = "ambient";

    fn check_at(&self, here: &Check<'_>) -> Result<(), ParameterError> {
        let positive = |name: &str, value: f64| {
            here.at(name).require((1e-9..=1e12).contains(&value), value, "a number from 1e-9 to 1e12")
        };
        positive("full_well_dn", self.full_well_dn)?;
        self.well().shape.check_at(here)?;
        here.at("clip").require((0.5..=1.0).contains(&self.clip), self.clip, "a share from 0.5 to 1")?;
        positive("target_dn_per_us", self.target_dn_per_us)?;
        let fine = (0.5..=1e3).contains(&self.own_charge);
        here.at("own_charge").require(fine, self.own_charge, "a number from 0.5 to 1000")?;
        let fine = (0.0..=1e12).contains(&self.ambient_dn_per_us);
        here.at("ambient_dn_per_us").require(fine, self.ambient_dn_per_us, "0 to 1e12")?;
        self.law.check_at(&here.at("law"))?;
        let fine = self.modulation_frequency_hz.is_none_or(|f| (1e3..=1e12).contains(&f));
        let found = self.modulation_frequency_hz.unwrap_or_default();
        here.at("modulation_frequency_hz").require(fine, found, "a frequency in Hz, 1e3 to 1e12")?;
        self.noise.map_or(Ok(()), |noise| noise.check_at(&here.at("noise")))
    }
}

impl AmbientNoise {
    fn check_at(self, here: &Check<'_>) -> Result<(), ParameterError> {
        let Self { read_variance_dn2: read, shot_variance_dn2_per_dn: shot } = self;
        let fine = (0.0..=1e12).contains(&read) && (0.0..=1e12).contains(&shot) && shot > 0.0;
        here.require(fine, format!("{read}, {shot}"), "variances from 0 to 1e12")
    }
}
