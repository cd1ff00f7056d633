//! How well predicted standard deviations fit the errors: coverage and expected normalized calibration error.

use std::collections::BTreeMap;

use serde::Serialize;

use crate::frame::{IntegrationTime, PixelFlags, Plane, Shape};
use crate::numerics::statistics::median;

use super::fraction::fraction;
use super::input::Times;
use super::outcome::{Outcome, Unavailable};

/// Predicted standard deviations beside the errors of the values.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct SigmaCoverage {
    /// Share of the errors that are within one σ, 0..=1: 0.683 for normal errors of that σ.
    pub within_one_sigma: f64,
    /// Expected normalized calibration error, dimensionless: the mean over ten groups of like σ of the difference
    /// between the root mean square of σ and that of the errors, over the former (Levi, Gispan, Giladi and Fetaya,
    /// "Evaluating and calibrating uncertainty prediction in regression tasks", Sensors 22, 2022). The groups are
    /// formed by the σ of neighbouring pixels.
    pub ence: f64,
    /// Errors that entered.
    pub errors: u64,
    /// Errors / values of all frames, 0..=1. The first frame of each run has nothing to be compared with.
    pub valid_fraction: f64,
}

/// The pixels whose signal-to-noise ratio lies in one range.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct CoverageStratum {
    /// Lower end of the range, included, dimensionless.
    pub snr_from: f64,
    /// Upper end, excluded; none for the last.
    pub snr_to: Option<f64>,
    /// Share of the errors that are within one σ, 0..=1; none without errors.
    pub within_one_sigma: Option<f64>,
    /// Errors that entered.
    pub errors: u64,
}

/// Counts errors and the σ that were predicted for them. Memory does not grow with their number.
#[derive(Clone, Debug, Default)]
pub struct SigmaTally {
    within: u64,
    beyond: u64,
    errors: u64,
    /// By the upper bits of the σ that the groups are formed by: eight groups an octave, to be joined.
    groups: BTreeMap<u32, Group>,
}

#[derive(Clone, Copy, Debug, Default)]
struct Group {
    count: u64,
    variance: f64,
    squares: f64,
}

impl SigmaTally {
    /// Groups that the error is the mean over.
    const GROUPS: u64 = 10;
    const SHIFT: u32 = 20;

    /// Takes one error in, all in one unit. `like` is the σ by which its group is chosen. It must not depend on the
    /// error: σ follows from the noisy value, and groups of it would gather errors that made their own σ large.
    /// A σ that is not positive and finite, or an error that is not finite, does not count.
    pub fn push(&mut self, error: f64, sigma: f64, like: f64) {
        let usable = |sigma: f64| sigma > 0.0 && sigma.is_finite();
        if !(usable(sigma) && usable(like) && error.is_finite()) {
            return;
        }
        self.errors += 1;
        self.within += u64::from(error.abs() <= sigma);
        self.beyond += u64::from(error.abs() > 3.0 * sigma);
        let group = self.groups.entry((like as f32).to_bits() >> Self::SHIFT).or_default();
        group.count += 1;
        group.variance += sigma * sigma;
        group.squares += error * error;
    }

    /// Errors taken in.
    #[must_use]
    pub fn errors(&self) -> u64 {
        self.errors
    }

    /// Share of the errors within one σ, 0..=1.
    #[must_use]
    pub fn within_one_sigma(&self) -> Option<f64> {
        (self.errors > 0).then(|| fraction(self.within, self.errors))
    }

    /// Share of the errors beyond three σ, 0..=1: 0.27 % of normal errors.
    #[must_use]
    pub fn beyond_three_sigma(&self) -> Option<f64> {
        (self.errors > 0).then(|| fraction(self.beyond, self.errors))
    }

    /// Expected normalized calibration error over ten groups of like number.
    #[must_use]
    pub fn ence(&self) -> Option<f64> {
        let (mut sum, mut groups, mut joined, mut taken) = (0.0, 0.0, Group::default(), 0);
        for group in self.groups.values() {
            joined.count += group.count;
            joined.variance += group.variance;
            joined.squares += group.squares;
            taken += group.count;
            // The group ends where its share of all errors is reached.
            if taken * Self::GROUPS >= self.errors * (groups as u64 + 1) {
                let (predicted, found) = (joined.variance.sqrt(), joined.squares.sqrt());
                sum += (predicted - found).abs() / predicted;
                groups += 1.0;
                joined = Group::default();
            }
        }
        (groups > 0.0).then(|| sum / groups)
    }
}

/// Compares each value with the mean of the earlier ones of its run (frames of one integration time, one after the
/// other). These errors, divided by `√(1 + 1/n)` for a mean of n, are as large as σ and independent of each other (the
/// recursive residuals of Brown, Durbin and Evans 1975).
#[derive(Clone, Debug)]
pub(super) struct CoverageMeter {
    pixels: Vec<Pixel>,
    tally: SigmaTally,
    same_time_ratio: f64,
    seen: bool,
}

#[derive(Clone, Copy, Debug, Default)]
struct Pixel {
    time_us: f32,
    frames: u32,
    sum: f64,
    variance: f64,
    within: u32,
    errors: u32,
}

impl CoverageMeter {
    pub(super) fn new(pixels: usize, same_time_ratio: f64) -> Self {
        let pixels = vec![Pixel::default(); pixels];
        Self { pixels, tally: SigmaTally::default(), same_time_ratio, seen: false }
    }

    /// Takes in a frame; NaN = unusable. A limited highlight has lost its error.
    pub(super) fn push(
        &mut self,
        usable: &[f32],
        sigma: &Plane<f32>,
        flags: &Plane<PixelFlags>,
        times: Times<'_>,
    ) {
        self.seen = true;
        let ratio = self.same_time_ratio;
        let shape = sigma.shape();
        for (index, (pixel, &value)) in self.pixels.iter_mut().zip(usable).enumerate() {
            let like = sigma_around(sigma.values(), shape, index);
            let (value, sigma) = (f64::from(value), f64::from(sigma.values()[index]));
            let time_us = times.at(index);
            let limited = flags.values()[index].contains(PixelFlags::SPECULAR);
            if value.is_nan() || limited || !(sigma > 0.0 && sigma.is_finite()) {
                continue;
            }
            if !IntegrationTime::same(time_us, pixel.time_us, ratio) {
                *pixel = Pixel { time_us, within: pixel.within, errors: pixel.errors, ..Pixel::default() };
            }
            if pixel.frames > 0 {
                let count = f64::from(pixel.frames);
                let of_mean = pixel.variance / (count * count);
                let error = value - pixel.sum / count;
                // The error of the value alone, had the mean none.
                let error = error * sigma / (sigma * sigma + of_mean).sqrt();
                self.tally.push(error, sigma, like.unwrap_or(sigma));
                pixel.within += u32::from(error.abs() <= sigma);
                pixel.errors += 1;
            }
            pixel.frames += 1;
            pixel.sum += value;
            pixel.variance += sigma * sigma;
        }
    }

    pub(super) fn finish(&self, values: u64) -> Outcome<SigmaCoverage> {
        let missing = if self.seen { Unavailable::NoRepeatedFrames } else { Unavailable::NoSigma };
        let (Some(within_one_sigma), Some(ence)) = (self.tally.within_one_sigma(), self.tally.ence()) else {
            return Err(missing);
        };
        let errors = self.tally.errors();
        Ok(SigmaCoverage { within_one_sigma, ence, errors, valid_fraction: fraction(errors, values) })
    }

    /// The same between consecutive `edges` of `snr`, below the first and above the last.
    pub(super) fn strata(&self, snr: &Plane<f32>, edges: &[f64]) -> Vec<CoverageStratum> {
        let starts = std::iter::once(0.0).chain(edges.iter().copied());
        let ends = edges.iter().copied().map(Some).chain(std::iter::once(None));
        let stratum = |(snr_from, snr_to): (f64, Option<f64>)| {
            let inside = |snr: f64| snr >= snr_from && snr_to.is_none_or(|end| snr < end);
            let members = self.pixels.iter().zip(snr.values()).filter(|(_, snr)| inside(f64::from(**snr)));
            let (within, errors) = members.fold((0, 0), |(within, errors), (pixel, _)| {
                (within + u64::from(pixel.within), errors + u64::from(pixel.errors))
            });
            let within_one_sigma = (errors > 0).then(|| fraction(within, errors));
            CoverageStratum { snr_from, snr_to, within_one_sigma, errors }
        };
        starts.zip(ends).map(stratum).collect()
    }
}

/// Median σ of the eight neighbours: it says how noisy the place is and knows nothing of the pixel's own error. `None`
/// where no neighbour has one.
fn sigma_around(sigma: &[f32], shape: Shape, index: usize) -> Option<f64> {
    let (row, column) = shape.place(index);
    let (mut around, mut count) = ([0.0; 8], 0);
    for near_row in row.saturating_sub(1)..(row + 2).min(shape.height) {
        for near_column in column.saturating_sub(1)..(column + 2).min(shape.width) {
            let near = f64::from(sigma[near_row * shape.width + near_column]);
            if (near_row, near_column) != (row, column) && near > 0.0 && near.is_finite() {
                around[count] = near;
                count += 1;
            }
        }
    }
    median(&mut around[..count])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Sums of twelve uniforms: variance 1, nearly normal.
    fn normal(state: &mut u64) -> f64 {
        let mut uniform = || {
            *state = state.wrapping_add(1);
            (crate::numerics::hash::splitmix64(*state) >> 11) as f64 / (1u64 << 53) as f64
        };
        (0..12).map(|_| uniform()).sum::<f64>() - 6.0
    }

    #[test]
    fn right_sigmas_cover_two_thirds_and_wrong_ones_show() {
        let (mut state, count) = (0, 40_000);
        for (factor, coverage, ence) in [(1.0, 0.683, 0.0), (2.0, 0.954, 0.5), (0.5, 0.383, 1.0)] {
            let mut tally = SigmaTally::default();
            for i in 0..count {
                let sigma = 1.0 + f64::from(i % 100) / 10.0;
                tally.push(sigma * normal(&mut state), factor * sigma, sigma);
            }
            // Standard errors: 0.23 % of a share, and 0.35 % of a deviation times √10 in each group; the sum of
            // uniforms differs from the normal law by 0.4 %.
            assert!((tally.within_one_sigma().unwrap() - coverage).abs() < 0.012);
            assert!((tally.ence().unwrap() - ence).abs() < 0.04, "{:?}", tally.ence());
        }
        assert_eq!(SigmaTally::default().ence(), None);
    }

    #[test]
    fn groups_that_do_not_know_the_errors_show_no_error_of_right_sigmas() {
        // σ is a fifth of the noisy value, as after d²: errors of a fifth make σ wrong by as much.
        let (mut state, mut by_truth, mut by_own) = (7, SigmaTally::default(), SigmaTally::default());
        for i in 0..40_000 {
            let truth = 1.0 + f64::from(i % 100) / 10.0;
            let value = truth * (1.0 + 0.2 * normal(&mut state));
            by_truth.push(value - truth, 0.2 * value, 0.2 * truth);
            by_own.push(value - truth, 0.2 * value, 0.2 * value);
        }
        // The mean of σ² is too large by 0.2², and of ten groups each has 1.1 % of statistical error.
        let [by_truth, by_own] = [by_truth, by_own].map(|tally| tally.ence().unwrap());
        assert!(by_truth < 0.02 + 2.0 * 0.011 && by_own > 1.5 * by_truth, "{by_truth} {by_own}");
    }

    #[test]
    fn values_are_compared_with_the_mean_of_the_earlier_ones_of_their_run() {
        let mut meter = CoverageMeter::new(1, 1.01);
        let shape = Shape::new(1, 1);
        let (sigma, flags) = (Plane::filled(shape, 1.0), Plane::filled(shape, PixelFlags::empty()));
        for (value, time_us) in [(10.0, 1.0), (12.0, 1.0), (12.0, 1.0), (50.0, 2.0), (50.5, 2.0)] {
            meter.push(&[value], &sigma, &flags, Times::Uniform(time_us));
        }
        // 2/√2 is without, 1/√1.5 within, and after a change of the time 0.5/√2 within.
        let found = meter.finish(5).unwrap();
        assert_eq!((found.errors, found.within_one_sigma), (3, 2.0 / 3.0));
        assert_eq!(found.valid_fraction, 0.6);
        let strata = meter.strata(&Plane::filled(Shape::new(1, 1), 12.0), &[5.0, 10.0]);
        assert_eq!(strata.iter().map(|stratum| stratum.errors).collect::<Vec<_>>(), [0, 0, 3]);
    }

    #[test]
    fn without_sigma_or_repeated_frames_there_is_a_reason() {
        let mut meter = CoverageMeter::new(1, 1.01);
        assert_eq!(meter.finish(0), Err(Unavailable::NoSigma));
        let shape = Shape::new(1, 1);
        let (sigma, flags) = (Plane::filled(shape, 1.0), Plane::filled(shape, PixelFlags::empty()));
        meter.push(&[1.0], &sigma, &flags, Times::Uniform(1.0));
        assert_eq!(meter.finish(1), Err(Unavailable::NoRepeatedFrames));
    }
}
