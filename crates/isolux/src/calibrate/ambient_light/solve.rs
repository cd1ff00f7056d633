//! The light that makes the noise fit.

use crate::calibrate::grouped_noise::GroupNoise;
use crate::numerics::minimum::minimum;
use crate::numerics::nonlinear::{least_squares, soft_loss};
use crate::numerics::statistics::median;
use crate::terms::response::AmbientResponse;

/// Why the ambient light of a recording is not known.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum AmbientUnknown {
    /// The calibration does not hold the noise of the amplitude.
    #[error("the distance sweep of the calibration had no repeated frames, so that the noise is not known")]
    NoNoise,
    /// Too few groups of pixels.
    #[error(
        "{found} groups of like pixels are bright enough to show their noise, at least {expected} expected"
    )]
    TooFewGroups {
        /// Number found.
        found: usize,
        /// Number that is needed.
        expected: usize,
    },
    /// The noise is not that of light on this camera.
    #[error(
        "the noise of the amplitudes differs from that of this camera by {:.0} %: another setting, or another smoothing",
        100.0 * misfit
    )]
    OtherNoise {
        /// Median deviation of the variance from what the light explains, relative.
        misfit: f64,
    },
    /// The noise allows very different lights.
    #[error("the noise tells the ambient light only to ±{:.0} % of the charge of a pixel", 100.0 * error)]
    Vague {
        /// Standard error of the charge of a typical pixel, relative.
        error: f64,
    },
}

/// Fewest groups of pixels.
const LEAST_GROUPS: usize = 4;
/// Groups with fewer differences are left out.
const LEAST_DIFFERENCES: f64 = 150.0;
/// Below this signal-to-noise ratio, an amplitude is Rician and its distance is not reliable.
const LEAST_SNR: f64 = 5.0;
/// A variance of n differences, most of them robust, has the relative error `√(2/n)` times this...
const ROBUST_ERROR: f64 = 1.4;
/// ...and that of the model beside it.
const MODEL_ERROR: f64 = 0.03;
/// Lights from 0 to 100 times the amplitude of the target: `B = 0.02 K sinh(x)`.
const SCALE: f64 = 0.02;
const LARGEST: f64 = 9.2;
/// Step of x for numeric derivatives.
const STEP: f64 = 1e-4;
/// Growth of the ambient light towards the corners over the camera's own: lobes fall by a factor of e³ at most.
const GROWTHS: std::ops::RangeInclusive<f64> = 0.0..=3.0;
/// It must be told by this many standard errors.
const SIGNIFICANT: f64 = 3.0;
/// A larger misfit is not that of light.
const LARGEST_MISFIT: f64 = 0.25;
/// A larger error of the charge would correct amplitudes by the wrong amount: half of it at a typical compression.
const LARGEST_ERROR: f64 = 0.2;

/// What the noise tells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Light {
    /// At the centre of the image, on the target of the calibration.
    pub(super) dn_per_us: f64,
    pub(super) error_dn_per_us: f64,
    /// [`AmbientLight::growth`](crate::standardize::AmbientLight).
    pub(super) growth: f64,
}

/// The light that the noise of these groups tells; its growth over the image may be known.
pub(super) fn solve(
    response: &AmbientResponse,
    groups: &[Group],
    growth: Option<f64>,
) -> Result<Light, AmbientUnknown> {
    if response.noise.is_none() {
        return Err(AmbientUnknown::NoNoise);
    }
    let groups: Vec<Group> = groups.iter().filter(|group| group.is_usable()).copied().collect();
    let found = groups.len();
    if found < LEAST_GROUPS {
        return Err(AmbientUnknown::TooFewGroups { found, expected: LEAST_GROUPS });
    }
    let scale = SCALE * response.target_dn_per_us;
    let residuals = |[x, growth]: [f64; 2]| {
        let light = scale * x.sinh();
        groups
            .iter()
            .map(move |group| group.residual(response, light * (growth * group.radius_squared).exp()))
    };
    // Texture and movement only add noise.
    let cost = |at: [f64; 2]| residuals(at).map(soft_loss).sum::<f64>();
    let known = growth.unwrap_or(0.0);
    let mut best = [minimum([0.0, LARGEST], |x| cost([x, known])), known];
    if growth.is_none() {
        let grown = least_squares(&[best[0], 0.5], |at, out| {
            out.clear();
            out.extend(residuals([at[0], at[1]]));
        });
        let grown = grown.map(|fitted| [fitted.parameters[0], fitted.parameters[1]]);
        let excess = (cost(best) / found as f64).max(1.0);
        let better = |at: &[f64; 2]| {
            GROWTHS.contains(&at[1]) && cost(best) - cost(*at) > SIGNIFICANT * SIGNIFICANT * excess
        };
        best = grown.filter(better).unwrap_or(best);
    }
    let mut deviations: Vec<f64> =
        groups.iter().zip(residuals(best)).map(|(group, residual)| (residual * group.error).abs()).collect();
    let misfit = median(&mut deviations).unwrap_or(f64::INFINITY);
    if misfit > LARGEST_MISFIT {
        return Err(AmbientUnknown::OtherNoise { misfit });
    }
    let dn_per_us = scale * best[0].sinh();
    // Derivatives by x, and of the light by x.
    let slopes =
        residuals([best[0] + STEP, best[1]]).zip(residuals(best)).map(|(there, here)| (there - here) / STEP);
    let information: f64 = slopes.map(|slope| slope * slope).sum();
    let excess = (cost(best) / found as f64).max(1.0);
    let by_chance = scale * best[0].cosh() * (excess / information).sqrt();
    // An error of the model is common to all groups.
    let mut charges: Vec<f64> = groups.iter().map(|group| group.charge(response, dn_per_us)).collect();
    let charge = median(&mut charges).unwrap_or(f64::INFINITY);
    let error_dn_per_us = by_chance.hypot(MODEL_ERROR * charge);
    let relative = error_dn_per_us / charge;
    if relative.is_nan() || relative > LARGEST_ERROR {
        return Err(AmbientUnknown::Vague { error: relative });
    }
    Ok(Light { dn_per_us, error_dn_per_us, growth: best[1] })
}

/// Pixels of like amplitude, distance and place.
#[derive(Clone, Copy, Debug)]
pub(super) struct Group {
    amplitude_dn: f64,
    /// Amplitude per µs of the calibration's target at their distance.
    target_dn_per_us: f64,
    /// Squared distance from the centre of the image, half the diagonal being 1.
    radius_squared: f64,
    variance_dn2: f64,
    differences: f64,
    error: f64,
}

impl Group {
    /// A group whose class is its ring, from 1, and whose light is that of the target.
    pub(super) fn of(noise: &GroupNoise, rings: f32) -> Option<Self> {
        let &GroupNoise { class, amplitude_dn, light, variance_dn2, differences } = noise;
        (light > 0.0 && variance_dn2 > 0.0).then(|| Self {
            amplitude_dn,
            target_dn_per_us: light,
            radius_squared: (class - 0.5) / f64::from(rings),
            variance_dn2,
            differences,
            error: MODEL_ERROR.hypot(ROBUST_ERROR * (2.0 / differences).sqrt()),
        })
    }

    fn is_usable(&self) -> bool {
        self.differences >= LEAST_DIFFERENCES && self.amplitude_dn > LEAST_SNR * self.variance_dn2.sqrt()
    }

    /// Deviation of the variance from what a light explains, in standard errors.
    fn residual(&self, response: &AmbientResponse, light: f64) -> f64 {
        let predicted = response.variance_dn2(self.amplitude_dn, self.target_dn_per_us, light);
        predicted.map_or(f64::INFINITY, |predicted| (self.variance_dn2 / predicted).ln() / self.error)
    }

    /// Charge per µs that the light and the camera's own put into a pixel that sees the target, DN/µs.
    fn charge(&self, response: &AmbientResponse, light: f64) -> f64 {
        response.own_charge * self.target_dn_per_us + light
    }
}
