//! Two frequencies tell distances apart over the range of their common divisor.
//!
//! The finer distance may be off by whole ranges c/2f of the higher frequency. Each of them is held against the coarser
//! distance, which may be off by whole ranges of the lower one; the one that agrees best is taken (Droeschel, Holz and
//! Behnke, "Multi-frequency phase unwrapping for time-of-flight cameras", IROS 2010, without the smoothness). What is not
//! surely the best is no distance: NaN.

use isolux::phase::SPEED_OF_LIGHT_M_PER_S;
use isolux::statistics::{SIGMA_PER_MAD, median};

use crate::recording::frequency::ModulationFrequency;

/// Pixels from which the noise of a frame is taken.
const SAMPLED_PIXELS: usize = 1 << 12;
/// A distance is sure where noise of so many standard deviations does not reach halfway to the next one.
const SURE: f64 = 4.0;
/// Share of that half way which is granted to what is no noise: quantisation, and delays that differ.
const GRANTED: f64 = 0.05;

/// Distances and amplitudes of two frequencies, as far as one pixel has them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pixel {
    pub(super) fine_m: f32,
    pub(super) coarse_m: f32,
    pub(super) fine_amplitude: f32,
    pub(super) coarse_amplitude: f32,
}

/// What unwraps the distances of two frequencies.
#[derive(Clone, Debug)]
pub(super) struct Unwrapping {
    fine_range_m: f64,
    coarse_range_m: f64,
    /// Ranges of the finer distance within the whole.
    wraps: usize,
    /// Typical disagreements of a frame: memory.
    scratch: Vec<f64>,
}

impl Unwrapping {
    pub(super) fn new(frequency: ModulationFrequency) -> Option<Self> {
        let ModulationFrequency::Pair([first, second]) = frequency else { return None };
        let range_m = |frequency_hz: f64| SPEED_OF_LIGHT_M_PER_S / (2.0 * frequency_hz);
        let (fine_range_m, coarse_range_m) = (range_m(first.max(second)), range_m(first.min(second)));
        let wraps = (frequency.unambiguous_range_m() / fine_range_m).round().max(1.0) as usize;
        Some(Self { fine_range_m, coarse_range_m, wraps, scratch: Vec::with_capacity(2 * SAMPLED_PIXELS) })
    }

    /// Unwraps the pixels of a frame into `out`.
    pub(super) fn unwrap_into<I: Iterator<Item = Pixel> + Clone>(&mut self, pixels: I, out: &mut [f32]) {
        let stride = out.len().div_ceil(SAMPLED_PIXELS) | 1;
        let mut scratch = std::mem::take(&mut self.scratch);
        scratch.clear();
        let sampled = pixels.clone().step_by(stride);
        scratch.extend(sampled.filter_map(|pixel| Some(self.best(pixel)?.1.abs() / self.noise(pixel))));
        // The best of several disagreements is small even where it is chance: a frame of noise is as wide as it can be.
        let unit = SIGMA_PER_MAD * median(&mut scratch).unwrap_or(f64::INFINITY);
        self.scratch = scratch;
        for (out, pixel) in out.iter_mut().zip(pixels) {
            let sure = self.best(pixel).filter(|(_, disagreement)| self.is_sure(pixel, *disagreement, unit));
            *out = sure.map_or(f32::NAN, |(distance_m, _)| distance_m as f32);
        }
    }

    /// The distance that both frequencies agree about best, and their disagreement, m.
    fn best(&self, pixel: Pixel) -> Option<(f64, f64)> {
        let (fine_m, coarse_m) = (f64::from(pixel.fine_m), f64::from(pixel.coarse_m));
        if !(fine_m.is_finite() && coarse_m.is_finite()) {
            return None;
        }
        let candidates = (0..self.wraps).map(|wrap| {
            let distance_m = fine_m + wrap as f64 * self.fine_range_m;
            let apart = distance_m - coarse_m;
            (distance_m, apart - self.coarse_range_m * (apart / self.coarse_range_m).round())
        });
        candidates.min_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))
    }

    /// Noise of the disagreement, up to a factor that is the same for all pixels: that of a phase goes with the inverse
    /// of its amplitude.
    fn noise(&self, pixel: Pixel) -> f64 {
        let fine = self.fine_range_m / f64::from(pixel.fine_amplitude);
        let coarse = self.coarse_range_m / f64::from(pixel.coarse_amplitude);
        fine.hypot(coarse)
    }

    /// True where the distance cannot be another one. `unit` is the standard deviation for [`Self::noise`] of 1.
    fn is_sure(&self, pixel: Pixel, disagreement: f64, unit: f64) -> bool {
        let half_way = 0.5 * self.coarse_range_m / self.wraps as f64;
        let noise = SURE * unit * self.noise(pixel) + GRANTED * half_way;
        disagreement.abs() <= noise && noise < half_way
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PAIR: ModulationFrequency = ModulationFrequency::Pair([60e6, 75e6]);

    fn unwrapped(pixels: &[Pixel]) -> Vec<f32> {
        let mut out = vec![0.0; pixels.len()];
        Unwrapping::new(PAIR).unwrap().unwrap_into(pixels.iter().copied(), &mut out);
        out
    }

    /// A pixel at a distance, with errors of both frequencies.
    fn pixel(distance_m: f64, fine_error_m: f64, coarse_error_m: f64, amplitude: f32) -> Pixel {
        let wrapped = |frequency_hz: f64, distance_m: f64| {
            distance_m.rem_euclid(SPEED_OF_LIGHT_M_PER_S / (2.0 * frequency_hz)) as f32
        };
        Pixel {
            fine_m: wrapped(75e6, distance_m + fine_error_m),
            coarse_m: wrapped(60e6, distance_m + coarse_error_m),
            fine_amplitude: amplitude,
            coarse_amplitude: amplitude,
        }
    }

    #[test]
    fn distances_are_told_apart_over_the_whole_range() {
        let truth = |step: usize| 0.1 + step as f64 * 0.02;
        let error = |step: usize| 0.003 * ((step % 7) as f64 - 3.0);
        let pixels: Vec<_> =
            (0..490).map(|step| pixel(truth(step), error(step), -error(step), 100.0)).collect();
        for (step, found) in unwrapped(&pixels).into_iter().enumerate() {
            assert!((f64::from(found) - truth(step) - error(step)).abs() < 1e-5, "{step}: {found}");
        }
    }

    #[test]
    fn what_disagrees_beyond_noise_has_no_distance() {
        let mut pixels: Vec<_> = (0..400)
            .map(|step| pixel(1.0 + 0.01 * step as f64, 0.004 * ((step % 5) as f64 - 2.0), 0.0, 100.0))
            .collect();
        // Half way between two distances; in the dark, where noise reaches that far; and nothing at all.
        pixels[7] = pixel(3.0, 0.0, 0.24, 100.0);
        pixels[8] = pixel(3.0, 0.0, 0.1, 1.0);
        pixels[9] = Pixel { fine_m: f32::NAN, ..pixels[10] };
        let found = unwrapped(&pixels);
        assert!(found[7..10].iter().all(|distance_m| distance_m.is_nan()), "{:?}", &found[7..10]);
        assert_eq!(found.iter().filter(|distance_m| distance_m.is_nan()).count(), 3);
        // A frame of noise: the two distances have nothing to do with each other.
        let random = |step: usize| (step * 7919 % 1000) as f64 / 1000.0;
        let noise: Vec<_> = (0..1000)
            .map(|step| pixel(10.0 * random(step), 0.0, 2.5 * random(step * step + 3), 50.0))
            .collect();
        assert!(unwrapped(&noise).iter().all(|distance_m| distance_m.is_nan()));
    }
}
