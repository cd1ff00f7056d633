//! What the noise of a window's pixels does to its ln A: how much the window weighs, whether it counts at all, and by
//! how much its median is too high.
//!
//! All three follow from the amplitude that is to be expected of the window, not from the one that was measured: a
//! window that came out too bright would count for more and be chosen more often, which bends the law over distance.

use std::collections::BTreeMap;

use super::measure::WindowMedians;
use crate::numerics::statistics::median;
use crate::terms::Noise;
use crate::terms::noise::{AmplitudeNoise, NoiseCell};

/// Standard deviation that no window's median is trusted beyond, in ln: the unevenness of targets.
const UNEVENNESS: f64 = 0.01;
/// Amplitudes must be expected to stand this many times above their noise: of fainter ones, the second-order bias is
/// not the whole.
const LEAST_SIGNAL_TO_NOISE: f64 = 5.0;
/// Variance of the median of n normal values, times n, over that of one: (1.25)².
const MEDIAN_VARIANCE: f64 = std::f64::consts::FRAC_PI_2;
/// Windows that a cell of the noise needs.
const LEAST_WINDOWS: usize = 8;
/// Cells per octave of the amplitude.
const CELLS_PER_OCTAVE: f64 = 2.0;
/// Share of the information on a variance that the median absolute deviation has.
const MAD_EFFICIENCY: f64 = 0.37;

/// The noise of the pixels of all windows.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct WindowNoise {
    by_amplitude: AmplitudeNoise,
}

/// What the noise does to one window.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Effect {
    /// Weight of its ln A, 0..=1; 0 where it is too faint.
    pub(super) weight: f64,
    /// By how much its ln A is too high.
    pub(super) bias: f64,
}

impl WindowNoise {
    /// Of the windows of all recordings. Pixels scatter for other reasons too, such as a texture, in some windows: each
    /// cell takes the median of the windows of one time and like amplitudes.
    pub(super) fn fit<'a>(windows: impl Iterator<Item = &'a WindowMedians>) -> Self {
        let mut cells: BTreeMap<(u32, i64), Vec<&WindowMedians>> = BTreeMap::new();
        for window in windows {
            let octaves = f64::from(window.ln_amplitude) * std::f64::consts::LOG2_E;
            let cell = (window.time_us.to_bits(), (octaves * CELLS_PER_OCTAVE).floor() as i64);
            cells.entry(cell).or_default().push(window);
        }
        let cells = cells.values().filter(|windows| windows.len() >= LEAST_WINDOWS);
        let cells: Vec<NoiseCell> = cells.filter_map(|windows| cell(windows)).collect();
        let by_amplitude = Noise::fit(&cells, 0.0, Vec::new()).map(|noise| noise.by_amplitude);
        Self { by_amplitude: by_amplitude.unwrap_or_default() }
    }

    /// Of a window whose amplitude is expected to be exp `ln_amplitude` DN.
    pub(super) fn effect(&self, window: &WindowMedians, ln_amplitude: f64) -> Effect {
        let amplitude_dn = ln_amplitude.exp();
        let time_us = if window.time_us.is_nan() { 0.0 } else { f64::from(window.time_us) };
        let relative = self.by_amplitude.variance_dn2(amplitude_dn, time_us) / (amplitude_dn * amplitude_dn);
        let of_median = MEDIAN_VARIANCE * relative / f64::from(window.pixels);
        let weight = UNEVENNESS * UNEVENNESS / (UNEVENNESS * UNEVENNESS + of_median);
        let bright = relative * LEAST_SIGNAL_TO_NOISE * LEAST_SIGNAL_TO_NOISE <= 1.0;
        // An amplitude is Rician: its median is too high by σ²/2a (methods, section 1). The logarithm of a noisy value
        // is too low by half its own relative variance.
        Effect { weight: if bright { weight } else { 0.0 }, bias: 0.5 * (relative - of_median) }
    }
}

fn cell(windows: &[&WindowMedians]) -> Option<NoiseCell> {
    let amplitude = |window: &&WindowMedians| f64::from(window.ln_amplitude).exp();
    let variance = |window: &&WindowMedians| (amplitude(window) * f64::from(window.scatter)).powi(2);
    let pixels: f64 = windows.iter().map(|window| f64::from(window.pixels)).sum();
    let time_us = f64::from(windows.first()?.time_us);
    Some(NoiseCell {
        integration_time_us: Some(time_us).filter(|time_us| !time_us.is_nan()),
        amplitude_dn: windows.iter().map(amplitude).sum::<f64>() / windows.len() as f64,
        intensity_dn: None,
        variance_dn2: median(&mut windows.iter().map(variance).collect::<Vec<_>>())?,
        differences: MAD_EFFICIENCY * pixels,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numerics::hash::splitmix64;
    use crate::numerics::statistics::{SIGMA_PER_MAD, median_absolute_deviation};

    const SIGMA_DN: f64 = 10.0;
    const PIXELS: usize = 25;

    /// Twelve uniform numbers make a normal one.
    fn normal(state: &mut u64) -> f64 {
        let mut uniform = || {
            *state += 1;
            (splitmix64(*state) >> 11) as f64 / (1u64 << 53) as f64
        };
        (0..12).map(|_| uniform()).sum::<f64>() - 6.0
    }

    /// A window of Rician amplitudes.
    fn window(amplitude_dn: f64, state: &mut u64) -> WindowMedians {
        let mut pixel = || (amplitude_dn + SIGMA_DN * normal(state)).hypot(SIGMA_DN * normal(state)).ln();
        let mut logs: Vec<f64> = (0..PIXELS).map(|_| pixel()).collect();
        let ln_amplitude = median(&mut logs).unwrap() as f32;
        let scatter = (SIGMA_PER_MAD * median_absolute_deviation(&mut logs).unwrap()) as f32;
        let (time_us, distance_m, cosine) = (1000.0, 1.0, 1.0);
        let pixels = PIXELS as u8;
        WindowMedians {
            frame: 0,
            label: 1,
            time_us,
            ln_amplitude,
            distance_m,
            measured_m: distance_m,
            pixel: [2; 2],
            cosine,
            scatter,
            pixels,
        }
    }

    #[test]
    fn windows_of_any_brightness_come_out_right_on_average() {
        const COUNT: usize = 4000;
        let mut state = 1;
        let levels = [60.0, 120.0, 1000.0];
        let windows: Vec<(f64, WindowMedians)> =
            (0..COUNT).flat_map(|_| levels).map(|level| (level, window(level, &mut state))).collect();
        let noise = WindowNoise::fit(windows.iter().map(|(_, window)| window));
        for level in levels {
            let mine = || windows.iter().filter(|(of, _)| *of == level).map(|(_, window)| window);
            let effect = noise.effect(mine().next().unwrap(), level.ln());
            let mean = mine().map(|window| f64::from(window.ln_amplitude)).sum::<f64>() / COUNT as f64;
            let relative = SIGMA_DN / level;
            // Four standard errors of the mean of medians; a fifth of the bias, because the noise is known to a tenth,
            // and orders beyond the second are left out.
            let tolerance = 4.0 * 1.25 * relative / ((PIXELS * COUNT) as f64).sqrt() + 0.1 * relative.powi(2);
            assert!((mean - level.ln() - effect.bias).abs() < tolerance, "{level}: {mean} {effect:?}");
            assert!(relative < 0.1 || mean - level.ln() > 2.0 * tolerance, "{level}: nothing to correct");
        }
    }

    #[test]
    fn a_window_that_is_expected_to_be_faint_does_not_count_however_bright_it_is() {
        let noise = WindowNoise {
            by_amplitude: AmplitudeNoise { read_variance_dn2: 100.0, ..AmplitudeNoise::default() },
        };
        let window = window(49.0, &mut 3);
        assert_eq!(noise.effect(&window, 49f64.ln()).weight, 0.0);
        assert!(noise.effect(&window, 51f64.ln()).weight > 0.0);
        // Without noise, all count alike.
        let none = WindowNoise::default().effect(&window, 0.0);
        assert_eq!(none, Effect { weight: 1.0, bias: 0.0 });
    }
}
