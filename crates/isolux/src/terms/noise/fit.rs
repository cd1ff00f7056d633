//! Fits the variances: weighted least squares over groups of similar pixels, no coefficient below 0.

use super::{AmplitudeNoise, IntensityNoise, Noise};
use crate::numerics::nnls;
use crate::terms::{FitQuality, Source, root_mean_square};

/// The noise of pixels of similar amplitude, intensity and integration time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NoiseCell {
    /// Mean integration time, µs; `None` where it is unknown.
    pub integration_time_us: Option<f64>,
    /// Mean amplitude, DN.
    pub amplitude_dn: f64,
    /// Mean intensity, DN; `None` where it is not recorded.
    pub intensity_dn: Option<f64>,
    /// Variance of one amplitude, DN².
    pub variance_dn2: f64,
    /// Number of differences that the variance was computed from.
    pub differences: f64,
}

/// Cells below this signal-to-noise ratio do not count: the amplitude is Rician there, and varies less.
const LEAST_SNR: f64 = 3.0;
/// Relative error of a variance by the intensity, besides that of chance, because saturation reduces the noise.
/// Without it, a cell of a million pixels would outweigh all others.
const COMPRESSION: f64 = 0.1;
/// The weights depend on the fitted variances; they settle to a per mille within this many rounds.
const ROUNDS: usize = 8;

/// Amplitude whose own noise hardly raises its mean.
fn is_lit(cell: &NoiseCell) -> bool {
    cell.amplitude_dn > LEAST_SNR * cell.variance_dn2.sqrt()
}

impl Noise {
    /// The largest signal-to-noise ratio of cells of which none is bright enough for a fit; `None` where one is, or there
    /// is none.
    #[must_use]
    pub fn too_dark(cells: &[NoiseCell]) -> Option<f64> {
        let noisy = || cells.iter().filter(|cell| cell.variance_dn2 > 0.0);
        let ratios = noisy().map(|cell| cell.amplitude_dn / cell.variance_dn2.sqrt());
        if noisy().any(is_lit) { None } else { ratios.reduce(f64::max) }
    }

    /// Fits the variances to the cells; the read noise is at least `least_read_variance_dn2` (that of the
    /// amplitude's own quantization). `None` where no cell shows any noise.
    #[must_use]
    pub fn fit(cells: &[NoiseCell], least_read_variance_dn2: f64, fitted_on: Vec<Source>) -> Option<Self> {
        let usable = |cell: &&NoiseCell| cell.variance_dn2 > 0.0 && is_lit(cell);
        let cells: Vec<NoiseCell> = cells.iter().filter(usable).copied().collect();
        let timed = cells.iter().all(|cell| cell.integration_time_us.is_some());
        let rows = |cell: &NoiseCell| {
            let time_us = cell.integration_time_us.filter(|_| timed).unwrap_or(0.0);
            [1.0, cell.amplitude_dn, time_us]
        };
        let [read, shot, ambient] = solve(&cells, 0.0, rows)?;
        let by_amplitude = AmplitudeNoise {
            read_variance_dn2: read.max(least_read_variance_dn2),
            shot_variance_dn2_per_dn: shot,
            ambient_variance_dn2_per_us: ambient,
        };
        let lit: Vec<NoiseCell> = cells.iter().filter(|cell| cell.intensity_dn.is_some()).copied().collect();
        let by_intensity =
            solve(&lit, COMPRESSION, |cell| [1.0, cell.intensity_dn.unwrap_or(0.0)]).map(|[read, shot]| {
                let read_variance_dn2 = read.max(least_read_variance_dn2);
                IntensityNoise { read_variance_dn2, shot_variance_dn2_per_dn: shot }
            });
        let predicted = |cell: &NoiseCell| match (by_intensity, cell.intensity_dn) {
            (Some(noise), Some(intensity_dn)) => {
                noise.read_variance_dn2 + noise.shot_variance_dn2_per_dn * intensity_dn
            }
            _ => {
                let time_us = cell.integration_time_us.filter(|_| timed).unwrap_or(0.0);
                by_amplitude.variance_dn2(cell.amplitude_dn, time_us)
            }
        };
        let errors = cells.iter().map(|cell| (predicted(cell) / cell.variance_dn2).sqrt() - 1.0);
        let residual = root_mean_square(errors)?;
        let fit = FitQuality { points: cells.len(), residual, held_out_residual: None };
        Some(Self { version: Self::VERSION, by_amplitude, by_intensity, fitted_on, fit })
    }
}

/// Coefficients of at least 0 of the columns that `row` makes of a cell, whose variance has this relative error beside
/// that of chance. With 0 every pixel weighs the same: where the model is not the truth, it is right for their mean.
/// `None` without cells.
fn solve<const N: usize>(
    cells: &[NoiseCell],
    model_error: f64,
    row: impl Fn(&NoiseCell) -> [f64; N],
) -> Option<[f64; N]> {
    let rows: Vec<[f64; N]> = cells.iter().map(row).collect();
    let mut scale = [0.0f64; N];
    rows.iter().for_each(|row| scale.iter_mut().zip(row).for_each(|(s, x)| *s = s.max(*x)));
    let variances_dn2: Vec<f64> = cells.iter().map(|cell| cell.variance_dn2).collect();
    let mut predicted = variances_dn2.clone();
    let mut found = None;
    for _ in 0..ROUNDS {
        let weight = |(cell, predicted): (&NoiseCell, &f64)| {
            // The variance of n normal values has the relative variance 2/n.
            1.0 / (predicted * predicted * (2.0 / cell.differences + model_error * model_error))
        };
        let weights: Vec<f64> = cells.iter().zip(&predicted).map(weight).collect();
        let coefficients = nnls::by_subsets(&rows, &variances_dn2, &weights, scale)?;
        for (predicted, row) in predicted.iter_mut().zip(&rows) {
            *predicted = row.iter().zip(&coefficients).map(|(x, c)| x * c).sum();
        }
        found = Some(coefficients);
        if !predicted.iter().all(|variance| *variance > 0.0) {
            break;
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Cells of a camera with read noise 9 DN², 0.5 DN² per DN of intensity, contrast 0.5 and ambient light.
    fn cells(ambient_dn_per_us: f64) -> Vec<NoiseCell> {
        let mut cells = Vec::new();
        for time_us in [500.0, 1000.0, 4000.0] {
            for light in [0.01, 0.05, 0.2, 0.4] {
                let active_dn = light * time_us;
                let intensity_dn = active_dn + ambient_dn_per_us * time_us;
                cells.push(NoiseCell {
                    integration_time_us: Some(time_us),
                    amplitude_dn: 0.5 * active_dn,
                    intensity_dn: Some(intensity_dn),
                    variance_dn2: 9.0 + 0.5 * intensity_dn,
                    differences: 1000.0,
                });
            }
        }
        cells
    }

    #[test]
    fn exact_variances_give_the_coefficients_back() {
        let noise = Noise::fit(&cells(0.1), 0.0, Vec::new()).unwrap();
        let AmplitudeNoise { read_variance_dn2, shot_variance_dn2_per_dn, ambient_variance_dn2_per_us } =
            noise.by_amplitude;
        // 0.5 DN² per DN of intensity are 1 per DN of amplitude at a contrast of 0.5.
        for (found, truth) in [
            (read_variance_dn2, 9.0),
            (shot_variance_dn2_per_dn, 1.0),
            (ambient_variance_dn2_per_us, 0.05),
            (noise.by_intensity.unwrap().read_variance_dn2, 9.0),
            (noise.by_intensity.unwrap().shot_variance_dn2_per_dn, 0.5),
        ] {
            assert!((found / truth - 1.0).abs() < 1e-9, "{found} {truth}");
        }
        assert!(noise.fit.residual < 1e-9 && noise.check().is_ok());
    }

    #[test]
    fn no_coefficient_is_negative_and_dark_cells_do_not_count() {
        // Falling with the amplitude: only a constant is left.
        let mut falling = cells(0.0);
        falling.iter_mut().for_each(|cell| cell.variance_dn2 = 9.0 - 0.001 * cell.amplitude_dn);
        let noise = Noise::fit(&falling, 0.0, Vec::new()).unwrap();
        assert_eq!(noise.by_amplitude.shot_variance_dn2_per_dn, 0.0);
        assert!(noise.by_amplitude.read_variance_dn2 > 8.0);
        let mut dark = cells(0.0);
        dark.iter_mut().for_each(|cell| cell.amplitude_dn = 1.0);
        assert_eq!(Noise::fit(&dark, 0.0, Vec::new()), None);
    }

    #[test]
    fn quantization_is_the_least_read_noise() {
        let mut quiet = cells(0.0);
        quiet.iter_mut().for_each(|cell| cell.variance_dn2 = 1e-4 * cell.amplitude_dn);
        let noise = Noise::fit(&quiet, 1.0 / 12.0, Vec::new()).unwrap();
        assert_eq!(noise.by_amplitude.read_variance_dn2, 1.0 / 12.0);
    }
}
