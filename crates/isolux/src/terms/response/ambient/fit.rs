//! Fits the well, the law over distance and the ambient light to the amplitudes of a flat target, and to their noise.
//!
//! All integration times share one law: `ln A = ln F(t K h(d); c(d), φ)`, and where positions have repeated frames
//! `ln V = ln V(…)`, with robust least squares. The amplitudes of two times at one distance differ from the ratio of
//! the times only by saturation, which is what determines the well.

use super::error::AmbientError;
use super::light::{Light, Well};
use super::model::{AmbientNoise, AmbientResponse, phase};
use super::sample::TargetSample;
use crate::numerics::bspline::Basis;
use crate::numerics::nonlinear::{Fitted, least_squares};
use crate::numerics::statistics::median;
use crate::terms::check::{Check, Parameters};
use crate::terms::response::well::SoftWell;
use crate::terms::spline::{Harmonic, Law};
use crate::terms::{FitQuality, Source, root_mean_square};

/// Fewest positions of all times.
const LEAST_SAMPLES: usize = 12;
/// Equal intervals of ln d. The weight on their curvature makes the law smooth.
const INTERVALS: usize = 10;
/// A second difference of the coefficients of this size weighs as much as a standard deviation. The law of an LED ring
/// of 0.1 m bends by 0.1 in the nearest interval.
const CURVATURE: f64 = 1.0;
/// Relative error of an amplitude besides its noise: warm-up, and ripple of higher order.
const MODEL_ERROR: f64 = 0.002;
/// The same of a variance.
const NOISE_MODEL_ERROR: f64 = 0.03;
/// Fewest positions with repeated frames from which the noise is fitted.
const LEAST_NOISE_ROWS: usize = 8;
/// A variance from n trimmed differences has the relative error `√(2/n)` times this.
const TRIMMED_ERROR: f64 = 1.2;
/// Prior of ln c0, modulation contrasts of 0.35 to 0.7; it fixes the gauge.
const OWN_CHARGE: [f64; 2] = [0.693, 0.35];
/// Prior of ln p: simulated and published wells lie between 4 and 8.
const SOFTNESS: [f64; 2] = [1.705, 0.35];
/// Prior of ln(1 − clip): bins clip at 0.93 to 0.98 of the full well.
const CLIP: [f64; 2] = [-3.0, 0.4];
/// Full wells that the search starts from, over the largest amplitude: no start leads to the best end always.
const STARTS: [f64; 3] = [2.0, 4.0, 8.0];
/// With less compression anywhere, the well is not determined: five times the model's own error is 1 %.
const LEAST_COMPRESSION: f64 = 0.02;
/// With larger relative errors, amplitudes are not those of a saturating pixel before one target.
const LARGEST_RESIDUAL: f64 = 0.05;

impl AmbientResponse {
    /// Fits the tier to the samples of several sweeps, each before a target of its own reflectivity. Those of the first
    /// define K.
    ///
    /// # Errors
    /// [`AmbientError`] when they do not determine it.
    pub(crate) fn fit(
        sweeps: &[Vec<TargetSample>],
        reference_m: f64,
        modulation_frequency_hz: Option<f64>,
        fitted_on: Vec<Source>,
    ) -> Result<Self, AmbientError> {
        let problem = Problem::new(sweeps, reference_m, modulation_frequency_hz)?;
        let best = problem.best().ok_or(AmbientError::Misfit { residual: f64::INFINITY })?;
        let residuals = problem.relative_errors(&best.parameters);
        let residual = root_mean_square(residuals).unwrap_or(f64::INFINITY);
        if residual.is_nan() || residual > LARGEST_RESIDUAL {
            return Err(AmbientError::Misfit { residual });
        }
        let most = problem.largest_compression(&best.parameters);
        if most < LEAST_COMPRESSION {
            return Err(AmbientError::NoCompression { most });
        }
        let fit = FitQuality { points: problem.rows.len(), residual, held_out_residual: None };
        let response = problem.response(&best.parameters, fitted_on, fit);
        response.check_at(&Check::of(Self::NAME)).map_err(|_| AmbientError::Misfit { residual })?;
        Ok(response)
    }
}

/// One sample, with what does not depend on the parameters.
struct Row {
    sample: TargetSample,
    sweep: usize,
    first: usize,
    splines: [f64; 4],
    harmonic: [f64; 2],
    phase: f64,
    ln_inverse_square: f64,
}

struct Problem {
    rows: Vec<Row>,
    sweeps: usize,
    basis: Basis,
    range_m: [f64; 2],
    reference_m: f64,
    modulation_frequency_hz: Option<f64>,
    with_noise: bool,
}

/// The parameters by name.
struct Parts<'a> {
    well: Well,
    own_charge: f64,
    ambient: f64,
    noise: AmbientNoise,
    splines: &'a [f64],
    harmonic: [f64; 2],
    /// ln of the reflectivity of each sweep's target over that of the first.
    targets: &'a [f64],
}

/// Parameters before the splines: ln of W, p, c0, B, read and shot noise; the harmonic; ln(1 − clip).
const SCALARS: usize = 9;

impl Problem {
    fn new(
        sweeps: &[Vec<TargetSample>],
        reference_m: f64,
        modulation_frequency_hz: Option<f64>,
    ) -> Result<Self, AmbientError> {
        let samples: Vec<(usize, TargetSample)> = sweeps
            .iter()
            .enumerate()
            .flat_map(|(sweep, samples)| samples.iter().map(move |sample| (sweep, *sample)))
            .collect();
        let found = samples.len();
        if found < LEAST_SAMPLES {
            return Err(AmbientError::TooFewSamples { found, expected: LEAST_SAMPLES });
        }
        let time_us = |(_, sample): &(usize, TargetSample)| sample.integration_time_us;
        if samples.iter().all(|sample| time_us(sample) == time_us(&samples[0])) {
            return Err(AmbientError::OneTime);
        }
        let distances = || samples.iter().map(|(_, sample)| sample.distance_m);
        let range_m = [distances().fold(f64::INFINITY, f64::min), distances().fold(0.0, f64::max)];
        if !(range_m[0]..=range_m[1]).contains(&reference_m) || range_m[0] <= 0.0 {
            return Err(AmbientError::ReferenceOutside { reference_m });
        }
        let basis = Basis::new(range_m[0].ln(), range_m[1].ln(), INTERVALS);
        let row = |(sweep, sample): (usize, TargetSample)| {
            let distance_m = sample.distance_m;
            let (first, splines) = basis.at(distance_m.ln());
            let harmonic = modulation_frequency_hz.map_or([0.0; 2], |f| Harmonic::columns(f, distance_m));
            let phase = phase(modulation_frequency_hz, distance_m);
            let ln_inverse_square = -2.0 * (distance_m / reference_m).ln();
            Row { sample, sweep, first, splines, harmonic, phase, ln_inverse_square }
        };
        let rows: Vec<Row> = samples.into_iter().map(row).collect();
        let with_noise = rows.iter().filter(|row| row.sample.noise.is_some()).count() >= LEAST_NOISE_ROWS;
        let sweeps = sweeps.len();
        Ok(Self { rows, sweeps, basis, range_m, reference_m, modulation_frequency_hz, with_noise })
    }

    /// The end with the least cost of searches from several starts.
    fn best(&self) -> Option<Fitted> {
        let ends = STARTS.iter().filter_map(|start| {
            least_squares(&self.start(*start), |parameters, out| self.residuals(parameters, out))
        });
        ends.min_by(|a, b| a.cost.total_cmp(&b.cost))
    }

    fn start(&self, wells: f64) -> Vec<f64> {
        let samples = || self.rows.iter().map(|row| row.sample);
        let largest_dn = samples().map(|s| s.amplitude_dn).fold(0.0, f64::max);
        let ln_rate = |row: &Row| {
            (row.sample.amplitude_dn / row.sample.integration_time_us).ln() - row.ln_inverse_square
        };
        let mut rates: Vec<f64> = self.rows.iter().map(ln_rate).collect();
        let ln_target = median(&mut rates).unwrap_or(0.0);
        let noisy = || samples().filter_map(|s| s.noise.map(|noise| (noise.variance_dn2, s.amplitude_dn)));
        let read = noisy().map(|(variance, _)| 0.5 * variance).fold(f64::INFINITY, f64::min).min(1e12);
        let mut shots: Vec<f64> = noisy().map(|(variance, amplitude)| 0.5 * variance / amplitude).collect();
        let shot = median(&mut shots).unwrap_or(1.0);
        let mut start = vec![
            (wells * largest_dn).ln(),
            SOFTNESS[0],
            OWN_CHARGE[0],
            ln_target,
            read.max(1e-12).ln(),
            shot.max(1e-12).ln(),
            0.0,
            0.0,
            CLIP[0],
        ];
        start.extend(std::iter::repeat_n(ln_target, self.basis.len()));
        start.extend(std::iter::repeat_n(0.0, self.sweeps.saturating_sub(1)));
        start
    }

    fn parts<'a>(&self, parameters: &'a [f64]) -> Parts<'a> {
        let (scalars, rest) = parameters.split_at(SCALARS);
        let (splines, targets) = rest.split_at(self.basis.len());
        let (low, high) = (*SoftWell::SOFTNESS_LIMITS.start(), *SoftWell::SOFTNESS_LIMITS.end());
        let softness = scalars[1].exp().clamp(low, high);
        Parts {
            well: Well {
                full_well_dn: scalars[0].exp(),
                shape: SoftWell { softness },
                clip: (1.0 - scalars[8].exp()).clamp(0.5, 1.0),
            },
            own_charge: scalars[2].exp(),
            ambient: scalars[3].exp(),
            noise: AmbientNoise {
                read_variance_dn2: scalars[4].exp(),
                shot_variance_dn2_per_dn: scalars[5].exp(),
            },
            splines,
            harmonic: [scalars[6], scalars[7]],
            targets,
        }
    }

    /// The light of a sample.
    fn light(&self, parts: &Parts<'_>, row: &Row) -> Light {
        let splines = &parts.splines[row.first..row.first + 4];
        let smooth: f64 = splines.iter().zip(row.splines).map(|(c, value)| c * value).sum();
        let harmonic = parts.harmonic[0] * row.harmonic[0] + parts.harmonic[1] * row.harmonic[1];
        let target = row.ln_inverse_square + smooth + harmonic;
        let reflectivity = if row.sweep == 0 { 0.0 } else { parts.targets[row.sweep - 1] };
        Light {
            amplitude_dn: row.sample.integration_time_us * (target + reflectivity).exp(),
            charge: parts.own_charge * (-harmonic).exp() + parts.ambient * (-target).exp(),
            phase: row.phase,
        }
    }

    /// Residuals in standard deviations: amplitudes, variances, curvature, priors.
    fn residuals(&self, parameters: &[f64], out: &mut Vec<f64>) {
        let parts = self.parts(parameters);
        let AmbientNoise { read_variance_dn2: read, shot_variance_dn2_per_dn: shot } = parts.noise;
        out.clear();
        for row in &self.rows {
            let light = self.light(&parts, row);
            let error = MODEL_ERROR.hypot(row.sample.relative_error);
            let kept = parts.well.amplitude_dn(light).max(f64::MIN_POSITIVE);
            out.push((kept / row.sample.amplitude_dn).ln() / error);
            if let Some(noise) = row.sample.noise.filter(|_| self.with_noise) {
                let error = NOISE_MODEL_ERROR.hypot(TRIMMED_ERROR * (2.0 / noise.differences).sqrt());
                let variance = parts.well.variance_dn2(light, read, shot);
                out.push((variance / noise.variance_dn2).ln() / error);
            }
        }
        out.extend(parts.splines.windows(3).map(|c| (c[0] - 2.0 * c[1] + c[2]) / CURVATURE));
        out.push((parameters[1] - SOFTNESS[0]) / SOFTNESS[1]);
        out.push((parameters[2] - OWN_CHARGE[0]) / OWN_CHARGE[1]);
        out.push((parameters[8] - CLIP[0]) / CLIP[1]);
    }

    fn relative_errors<'a>(&'a self, parameters: &'a [f64]) -> impl Iterator<Item = f64> + 'a {
        let parts = self.parts(parameters);
        self.rows
            .iter()
            .map(move |row| parts.well.amplitude_dn(self.light(&parts, row)) / row.sample.amplitude_dn - 1.0)
    }

    fn largest_compression(&self, parameters: &[f64]) -> f64 {
        let parts = self.parts(parameters);
        let compression = |row: &Row| {
            let light = self.light(&parts, row);
            1.0 - parts.well.amplitude_dn(light) / light.amplitude_dn
        };
        self.rows.iter().map(compression).fold(0.0, f64::max)
    }

    fn response(&self, parameters: &[f64], fitted_on: Vec<Source>, fit: FitQuality) -> AmbientResponse {
        let parts = self.parts(parameters);
        let harmonic = self.modulation_frequency_hz.map(|modulation_frequency_hz| Harmonic {
            modulation_frequency_hz,
            cosine: parts.harmonic[0],
            sine: parts.harmonic[1],
        });
        let mut law = Law {
            reference_distance_m: self.reference_m,
            valid_distance_m: self.range_m,
            coefficients: parts.splines.to_vec(),
            harmonic,
            curvature_weight: 0.0,
        };
        let at_reference = law.ln_response(self.reference_m);
        law.coefficients.iter_mut().for_each(|c| *c -= at_reference);
        AmbientResponse {
            full_well_dn: parts.well.full_well_dn,
            softness: parts.well.shape.softness,
            clip: parts.well.clip,
            own_charge: parts.own_charge,
            ambient_dn_per_us: parts.ambient,
            target_dn_per_us: at_reference.exp(),
            law,
            modulation_frequency_hz: self.modulation_frequency_hz,
            noise: self.with_noise.then_some(parts.noise),
            fitted_on,
            fit,
        }
    }
}
