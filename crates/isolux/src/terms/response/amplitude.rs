//! Tier T1, `amplitude`: a curve from amplitude to saturation-corrected amplitude, both DN. It needs no other
//! channel, but ignores ambient light: two pixels of the same amplitude may be saturated differently. It is valid
//! where the light is mostly the camera's own, as in its sweep.
//!
//! `ln(A_lin / A) = Σ c_k max(0, ln A − u_k)`, all c_k ≥ 0: the correction is never below 1 and grows ever faster.
//! No hinge lies on the two lowest knots, which makes dim amplitudes linear (methods, section 2).

use serde::{Deserialize, Serialize};

use super::ResponseError;
use super::means::AmplitudeStack;
use super::still::{LEAST_SAMPLES, StillScene};
use crate::numerics::nnls;
use crate::numerics::robust::{biweight, tukey_share};
use crate::numerics::statistics::{SIGMA_PER_MAD, median, quantile};
use crate::terms::check::{Check, ParameterError, Parameters};
use crate::terms::{FitQuality, Source, root_mean_square};

/// Saturation-corrected amplitude as a function of the amplitude.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AmplitudeResponse {
    /// Amplitudes at which the curve bends, DN, increasing.
    pub hinge_dn: Vec<f64>,
    /// By how much the exponent `d ln(A_lin/A) / d ln A` grows at each of them, at least 0.
    pub increment: Vec<f64>,
    /// Largest amplitude of the fit, DN; a pixel above is refused.
    pub largest_dn: f64,
    /// The recordings that it was fitted to.
    pub fitted_on: Vec<Source>,
    /// How well it fits: relative deviation of the linearised amplitudes from proportion to time.
    pub fit: FitQuality,
}

/// Equal steps of ln A between the lowest knot and the largest amplitude.
const KNOTS: usize = 24;
/// The largest amplitude over the lowest knot. Below, soft wells of p ≥ 4 compress by less than 1e-4.
const SPAN: f64 = 12.0;
/// Pixels of each scene that enter the fit.
const PIXELS: usize = 2000;
/// Weight of the penalty on the differences of neighbouring increments, relative to the data's.
const SMOOTHNESS: f64 = 1e-4;
/// Rounds of reweighting.
const ROUNDS: usize = 4;
/// What a curve of straight pieces leaves: most samples are linear and have less, and must not make outliers of those
/// that are compressed.
const LEAST_SIGMA: f64 = 0.005;

/// A sample: ln A, ln (A/t), weight.
type Row = [f64; 3];

impl AmplitudeResponse {
    /// Fits the curve to mean amplitudes of still scenes. Samples below `least_amplitude_dn` are left out, and each
    /// pixel's falling branch. Robust: Tukey's biweight. Held-out residual: every second pixel, from a fit to the others.
    ///
    /// # Errors
    /// [`ResponseError`] when hardly any pixel is compressed.
    pub(crate) fn fit(
        stacks: &[&AmplitudeStack],
        least_amplitude_dn: f64,
        fitted_on: Vec<Source>,
    ) -> Result<Self, ResponseError> {
        let pixels = collect(stacks, least_amplitude_dn);
        let mut largest: Vec<f64> = pixels.iter().filter_map(|rows| rows.last()).map(|row| row[0]).collect();
        let top = quantile(&mut largest, 0.99).ok_or(ResponseError::NoCompression)?;
        let step = SPAN.ln() / (KNOTS - 1) as f64;
        let hinges: Vec<f64> = (2..KNOTS - 1).map(|k| top - SPAN.ln() + step * k as f64).collect();
        let inside: Vec<Vec<Row>> = pixels
            .into_iter()
            .map(|rows| rows.into_iter().filter(|row| row[0] <= top).collect::<Vec<_>>())
            .filter(|rows| rows.len() >= LEAST_SAMPLES)
            .collect();
        let increment = robust(&hinges, inside.iter()).ok_or(ResponseError::NoCompression)?;
        let halves = [0, 1].map(|half| inside.iter().skip(half).step_by(2));
        let [first, second] = halves;
        let held_out = robust(&hinges, first)
            .and_then(|increment| root_mean_square(errors(&hinges, &increment, second)));
        let fit = FitQuality {
            points: inside.iter().map(Vec::len).sum(),
            residual: root_mean_square(errors(&hinges, &increment, inside.iter())).unwrap_or(0.0),
            held_out_residual: held_out,
        };
        let hinge_dn = hinges.into_iter().map(f64::exp).collect();
        Ok(Self { hinge_dn, increment, largest_dn: top.exp(), fitted_on, fit })
    }

    /// Linear amplitude of an amplitude, both DN; `None` above the range.
    #[must_use]
    pub fn linear_dn(&self, amplitude_dn: f64) -> Option<f64> {
        let bent = |(hinge, increment): (&f64, &f64)| increment * (amplitude_dn / hinge).ln().max(0.0);
        let exponent: f64 = self.hinge_dn.iter().zip(&self.increment).map(bent).sum();
        (amplitude_dn <= self.largest_dn).then(|| amplitude_dn * exponent.exp())
    }

    /// Prepared for many pixels.
    pub(crate) fn planned(&self) -> PlannedAmplitude {
        const INTERVALS: usize = 4096;
        let step = self.largest_dn / INTERVALS as f64;
        // Rounding may put the last one above the range.
        let linear = |i: usize| self.linear_dn((i as f64 * step).min(self.largest_dn)).unwrap_or(0.0);
        PlannedAmplitude { intervals_per_dn: 1.0 / step, linear_dn: (0..=INTERVALS).map(linear).collect() }
    }
}

impl Parameters for AmplitudeResponse {
    const NAME: &'static str = "amplitude";

    fn check_at(&self, here: &Check<'_>) -> Result<(), ParameterError> {
        let (hinges, increments) = (&self.hinge_dn, &self.increment);
        let positive = |x: f64| x > 0.0 && x < 1e12;
        let increasing = hinges.windows(2).all(|w| w[0] < w[1]) && hinges.iter().all(|h| positive(*h));
        let expected = "increasing positive DN";
        here.at("hinge_dn").require(increasing, "not increasing from above 0", expected)?;
        let counts = format!("{} for {} hinges", increments.len(), hinges.len());
        let at_increments = here.at("increment");
        at_increments.require(increments.len() == hinges.len(), counts, "one for each hinge")?;
        let impossible = increments.iter().find(|c| !(0.0..=1e3).contains(*c));
        let found = impossible.map_or_else(String::new, f64::to_string);
        at_increments.require(impossible.is_none(), found, "numbers from 0 to 1000")?;
        let largest = self.linear_dn(self.largest_dn).unwrap_or(f64::NAN);
        let fine = positive(self.largest_dn) && positive(largest);
        here.at("largest_dn").require(fine, self.largest_dn, "positive DN of a finite linear value")
    }
}

/// The curve as a table: between its 4096 steps of a smooth curve, linear interpolation errs by parts in 1e6.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct PlannedAmplitude {
    intervals_per_dn: f64,
    linear_dn: Vec<f64>,
}

impl PlannedAmplitude {
    /// Linear amplitude in DN; `None` above the range.
    pub(crate) fn linearise(&self, amplitude_dn: f32) -> Option<f32> {
        let position = f64::from(amplitude_dn) * self.intervals_per_dn;
        let index = position as usize;
        match self.linear_dn.get(index..index.saturating_add(2)) {
            Some(&[low, high]) => Some((low + (high - low) * (position - index as f64)) as f32),
            _ => None,
        }
    }
}

/// Samples of pixels spread over each scene, those that are compressed and others.
fn collect(stacks: &[&AmplitudeStack], least_amplitude_dn: f64) -> Vec<Vec<Row>> {
    let mut samples = Vec::new();
    let mut pixels = Vec::new();
    for stack in stacks {
        let scene = StillScene::new(stack, least_amplitude_dn);
        let count = stack.shape().pixels();
        let others = (0..count).step_by(count.div_ceil(PIXELS / 2).max(1));
        let mut chosen: Vec<usize> = scene.compressed(PIXELS / 2).into_iter().chain(others).collect();
        chosen.sort_unstable();
        chosen.dedup();
        for pixel in chosen {
            scene.series_into(pixel, &mut samples);
            let row =
                |s: &super::fill_time::Sample| [s.ln_rate + scene.times_us[s.time].ln(), s.ln_rate, s.weight];
            if samples.len() >= LEAST_SAMPLES {
                pixels.push(samples.iter().map(row).collect());
            }
        }
    }
    pixels
}

fn exponent(hinges: &[f64], increment: &[f64], ln_amplitude: f64) -> f64 {
    hinges.iter().zip(increment).map(|(hinge, c)| c * (ln_amplitude - hinge).max(0.0)).sum()
}

/// ln of linear amplitude over time of each sample, less its weighted mean over the pixel.
fn residuals(hinges: &[f64], increment: &[f64], rows: &[Row]) -> Vec<f64> {
    let linear = |row: &Row| row[1] + exponent(hinges, increment, row[0]);
    let weights: f64 = rows.iter().map(|row| row[2]).sum();
    let level = rows.iter().map(|row| row[2] * linear(row)).sum::<f64>() / weights;
    rows.iter().map(|row| linear(row) - level).collect()
}

fn errors<'a>(
    hinges: &'a [f64],
    increment: &'a [f64],
    pixels: impl Iterator<Item = &'a Vec<Row>> + 'a,
) -> impl Iterator<Item = f64> + 'a {
    pixels.flat_map(move |rows| residuals(hinges, increment, rows)).map(f64::exp_m1)
}

/// Increments of the least robust squares; `None` when no pixel bends.
fn robust<'a>(hinges: &[f64], pixels: impl Iterator<Item = &'a Vec<Row>>) -> Option<Vec<f64>> {
    let pixels: Vec<&Vec<Row>> = pixels.collect();
    let mut increment = vec![0.0; hinges.len()];
    let mut weights: Vec<Vec<f64>> = pixels.iter().map(|rows| rows.iter().map(|r| r[2]).collect()).collect();
    for _ in 0..ROUNDS {
        increment = least_squares(hinges, &pixels, &weights);
        let standardized: Vec<Vec<f64>> = pixels
            .iter()
            .map(|rows| {
                let residuals = residuals(hinges, &increment, rows);
                residuals.iter().zip(rows.iter()).map(|(r, row)| r * row[2].sqrt()).collect()
            })
            .collect();
        let mut sizes: Vec<f64> = standardized.iter().flatten().map(|r| r.abs()).collect();
        let sigma = (SIGMA_PER_MAD * median(&mut sizes)?).max(LEAST_SIGMA);
        for ((weights, rows), residuals) in weights.iter_mut().zip(&pixels).zip(standardized) {
            for ((weight, row), residual) in weights.iter_mut().zip(rows.iter()).zip(residuals) {
                *weight = row[2] * biweight(tukey_share(residual, sigma));
            }
        }
    }
    increment.iter().any(|c| *c > 0.0).then_some(increment)
}

/// Weighted least squares with increments of at least 0: each pixel's level is eliminated by centring its rows.
fn least_squares(hinges: &[f64], pixels: &[&Vec<Row>], weights: &[Vec<f64>]) -> Vec<f64> {
    let count = hinges.len();
    let (mut matrix, mut right) = (vec![vec![0.0; count]; count], vec![0.0; count]);
    for (rows, weights) in pixels.iter().zip(weights) {
        let total: f64 = weights.iter().sum();
        if total <= 0.0 {
            continue;
        }
        let mean = |value: &dyn Fn(&Row) -> f64| {
            rows.iter().zip(weights).map(|(row, w)| w * value(row)).sum::<f64>() / total
        };
        let level = mean(&|row| row[1]);
        let centres: Vec<f64> = hinges.iter().map(|hinge| mean(&|row| (row[0] - hinge).max(0.0))).collect();
        for (row, weight) in rows.iter().zip(weights) {
            let bent: Vec<f64> =
                hinges.iter().zip(&centres).map(|(hinge, c)| (row[0] - hinge).max(0.0) - c).collect();
            for i in 0..count {
                right[i] -= weight * bent[i] * (row[1] - level);
                for j in 0..count {
                    matrix[i][j] += weight * bent[i] * bent[j];
                }
            }
        }
    }
    let penalty = SMOOTHNESS * (0..count).map(|i| matrix[i][i]).sum::<f64>() / count as f64;
    for i in 1..count {
        matrix[i][i] += penalty;
        matrix[i - 1][i - 1] += penalty;
        matrix[i][i - 1] -= penalty;
        matrix[i - 1][i] -= penalty;
    }
    nnls::by_coordinates(&matrix, &right)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::Shape;
    use crate::terms::response::SoftWell;

    /// Pixels of many brightnesses and one contrast: the fill is a function of the amplitude.
    #[test]
    fn without_ambient_light_the_curve_is_that_of_the_well() {
        let well = SoftWell { softness: 5.0 };
        let amplitude = |fill: f64| 1000.0 * fill * well.slope(fill);
        let mut stack = AmplitudeStack::new(Shape::new(1, 60));
        for time in 1..=30 {
            let fill = |pixel: i32| 0.001 * f64::from(time) * 1.06f64.powi(pixel);
            stack.push(1000.0 * f64::from(time), (0..60).map(|pixel| amplitude(fill(pixel)) as f32));
        }
        let found = AmplitudeResponse::fit(&[&stack], 0.0, Vec::new()).unwrap();
        assert!(found.check_at(&Check::of("amplitude")).is_ok());
        for fill in [0.05, 0.2, 0.4, 0.5, 0.55] {
            let linear = found.linear_dn(amplitude(fill)).unwrap();
            // Straight pieces of a tenth of ln A, and a curve that steepens: 1 %.
            assert!((linear / (1000.0 * fill) - 1.0).abs() < 0.01, "{fill}: {linear}");
        }
        assert_eq!(found.linear_dn(1.01 * found.largest_dn), None);
        let planned = found.planned();
        for amplitude_dn in [3.0, 150.0, 0.999 * found.largest_dn] {
            let exact = found.linear_dn(amplitude_dn).unwrap();
            let fast = f64::from(planned.linearise(amplitude_dn as f32).unwrap());
            assert!((fast / exact - 1.0).abs() < 1e-4, "{fast} {exact}");
        }
        assert_eq!(planned.linearise(1.01 * found.largest_dn as f32), None);
    }

    #[test]
    fn a_linear_scene_has_no_curve() {
        let mut stack = AmplitudeStack::new(Shape::new(1, 30));
        for time in 1..=9u8 {
            stack.push(f64::from(time), (1..=30u8).map(|rate| f32::from(rate) * f32::from(time)));
        }
        let linear =
            AmplitudeResponse::fit(&[&stack], 0.0, Vec::new()).map(|found| found.linear_dn(200.0).unwrap());
        // Rounding may leave a bend of the size of f32's ε.
        assert!(linear.as_ref().map_or(true, |linear| (linear / 200.0 - 1.0).abs() < 1e-5), "{linear:?}");
    }
}
