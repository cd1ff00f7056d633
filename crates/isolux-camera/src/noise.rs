//! Random numbers that are the same on every machine: ChaCha8 streams, and samplers on `libm` alone.
//!
//! `rand_distr` is not used: its logarithms and exponentials come from `std` or `libm` depending on which
//! features other crates of the build enable, so its bits may change with a dependency.

use std::sync::LazyLock;

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

/// What a stream of random numbers is for. Streams of different purposes never overlap.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Purpose {
    /// Shot and read noise of one row of one frame.
    Row = 1,
    /// Choice of the dead pixels.
    DeadPixels = 2,
    /// Choice of a random camera.
    RandomCamera = 3,
}

/// A stream of random numbers.
pub(crate) struct Noise {
    generator: ChaCha8Rng,
    layers: &'static Ziggurat,
}

impl Noise {
    /// Stream number `stream` of `seed`: a counter-based generator, so that any row of any frame can be
    /// made without the others.
    pub(crate) fn new(seed: u64, purpose: Purpose, stream: u64) -> Self {
        let mut key = [0; 32];
        key[..8].copy_from_slice(&seed.to_le_bytes());
        key[8] = purpose as u8;
        let mut generator = ChaCha8Rng::from_seed(key);
        generator.set_stream(stream);
        Self { generator, layers: &ZIGGURAT }
    }

    /// Uniform in (0, 1], 53 bits.
    #[inline]
    pub(crate) fn uniform(&mut self) -> f64 {
        unit(self.generator.next_u64())
    }

    /// Uniform in `low`..`high`.
    pub(crate) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.uniform()
    }

    /// Standard normal: the ziggurat of Marsaglia and Tsang (2000), 256 layers.
    #[inline]
    pub(crate) fn normal(&mut self) -> f64 {
        loop {
            let bits = self.generator.next_u64();
            let layer = (bits & 0xff) as usize;
            let x = (2.0 * unit(bits) - 1.0) * self.layers.edge[layer];
            if x.abs() < self.layers.edge[layer + 1] {
                return x;
            }
            if let Some(x) = self.normal_outside_the_core(layer, x) {
                return x;
            }
        }
    }

    #[cold]
    fn normal_outside_the_core(&mut self, layer: usize, x: f64) -> Option<f64> {
        if layer == 0 {
            return Some(self.normal_tail().copysign(x));
        }
        let (low, high) = (self.layers.density[layer], self.layers.density[layer + 1]);
        (high + (low - high) * self.uniform() < libm::exp(-0.5 * x * x)).then_some(x)
    }

    /// Magnitude beyond the last layer (Marsaglia 1964).
    fn normal_tail(&mut self) -> f64 {
        loop {
            let beyond = -libm::log(self.uniform()) / Ziggurat::TAIL;
            if -2.0 * libm::log(self.uniform()) > beyond * beyond {
                return Ziggurat::TAIL + beyond;
            }
        }
    }

    /// A count with Poisson statistics of mean (and variance) `mean`; 0 when `mean` is not positive.
    ///
    /// Below [`EXACT_BELOW`] by inversion, exactly. Above, the Cornish–Fisher expansion of its quantile
    /// function to third order, `μ + √μ z + (z²−1)/6 + (z−z³)/(72 √μ)`, not rounded to whole electrons:
    /// mean, variance and skewness are those of the Poisson law to 1e-4 of a standard deviation there, and it
    /// costs one normal number. Rounding would add 1/12 to the variance.
    #[inline]
    pub(crate) fn poisson(&mut self, mean: f64) -> f64 {
        if mean < EXACT_BELOW {
            return self.small_poisson(mean);
        }
        let z = self.normal();
        let root = mean.sqrt();
        (mean + root * z + (z * z - 1.0) / 6.0 + (z - z * z * z) / (72.0 * root)).max(0.0)
    }

    fn small_poisson(&mut self, mean: f64) -> f64 {
        if mean <= 0.0 || mean.is_nan() {
            return 0.0;
        }
        let mut left = self.uniform();
        let mut probability = libm::exp(-mean);
        let mut count = 0.0;
        // The bound ends the search where rounding leaves a remainder of `left`: P(count > 200) < 1e-60.
        while left > probability && count < 200.0 {
            left -= probability;
            count += 1.0;
            probability *= mean / count;
        }
        count
    }
}

/// Mean below which Poisson counts are drawn exactly.
pub(crate) const EXACT_BELOW: f64 = 32.0;

/// The upper 53 bits as a number in (0, 1].
#[inline]
fn unit(bits: u64) -> f64 {
    ((bits >> 11) + 1) as f64 * (1.0 / (1u64 << 53) as f64)
}

static ZIGGURAT: LazyLock<Ziggurat> = LazyLock::new(Ziggurat::new);

/// Layers of equal area under the normal density exp(−x²/2).
struct Ziggurat {
    /// Outer edge of each layer, falling from the base to 0.
    edge: [f64; 257],
    /// Density at the edges.
    density: [f64; 257],
}

impl Ziggurat {
    /// Where the tail begins when there are 256 layers.
    const TAIL: f64 = 3.654_152_885_361_009;

    fn new() -> Self {
        let density = |x: f64| libm::exp(-0.5 * x * x);
        // The base layer is a rectangle and the tail beyond it.
        let tail_area =
            std::f64::consts::FRAC_PI_2.sqrt() * libm::erfc(Self::TAIL / std::f64::consts::SQRT_2);
        let area = Self::TAIL * density(Self::TAIL) + tail_area;
        let mut edge = [0.0; 257];
        edge[0] = area / density(Self::TAIL);
        edge[1] = Self::TAIL;
        for layer in 2..256 {
            let below = edge[layer - 1];
            edge[layer] = (-2.0 * libm::log(area / below + density(below))).sqrt();
        }
        Self { edge, density: edge.map(density) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Mean, variance, skewness and excess kurtosis.
    fn moments(count: usize, mut sample: impl FnMut() -> f64) -> [f64; 4] {
        let samples: Vec<f64> = (0..count).map(|_| sample()).collect();
        let mean = samples.iter().sum::<f64>() / count as f64;
        let central = |power| samples.iter().map(|x| (x - mean).powi(power)).sum::<f64>() / count as f64;
        let variance = central(2);
        [mean, variance, central(3) / variance.powf(1.5), central(4) / variance.powi(2) - 3.0]
    }

    /// Five standard errors of each moment's estimate for a nearly normal law.
    fn tolerances(count: usize, variance: f64) -> [f64; 4] {
        let n = count as f64;
        [
            5.0 * (variance / n).sqrt(),
            5.0 * variance * (2.1 / n).sqrt(),
            5.0 * (6.5 / n).sqrt(),
            5.0 * (26.0 / n).sqrt(),
        ]
    }

    #[test]
    fn normal_numbers_have_the_moments_and_tails_of_the_law() {
        let count = 1_000_000;
        let mut noise = Noise::new(3, Purpose::Row, 0);
        let found = moments(count, || noise.normal());
        for ((found, expected), tolerance) in
            found.into_iter().zip([0.0, 1.0, 0.0, 0.0]).zip(tolerances(count, 1.0))
        {
            assert!((found - expected).abs() < tolerance, "{found} {expected}");
        }
        // P(|z| > 3.6541…), the part that comes from the tail sampler alone, is 2.58e-4.
        let beyond = (0..count).filter(|_| noise.normal().abs() > Ziggurat::TAIL).count() as f64;
        assert!((beyond - 258.0).abs() < 5.0 * 258f64.sqrt(), "{beyond}");
    }

    #[test]
    fn counts_have_the_moments_of_the_poisson_law_on_both_sides_of_the_threshold() {
        let count = 400_000;
        for (stream, mean) in [0.3, 4.0, 31.9, 32.1, 100.0, 5e3, 3e5].into_iter().enumerate() {
            let mut noise = Noise::new(5, Purpose::Row, stream as u64);
            let found = moments(count, || noise.poisson(mean));
            let expected = [mean, mean, 1.0 / mean.sqrt(), 1.0 / mean];
            // Higher moments of a skewed law scatter more: widened by its own fourth moment.
            let widened = 1.0 + 2.0 / mean;
            for ((found, expected), tolerance) in found.into_iter().zip(expected).zip(tolerances(count, mean))
            {
                assert!((found - expected).abs() < widened * tolerance, "λ {mean}: {found} {expected}");
            }
        }
    }

    #[test]
    fn no_light_gives_no_electrons() {
        let mut noise = Noise::new(1, Purpose::Row, 0);
        assert_eq!(noise.poisson(0.0), 0.0);
        assert_eq!(noise.poisson(-1.0), 0.0);
        assert_eq!(noise.poisson(f64::NAN), 0.0);
    }

    #[test]
    fn streams_differ() {
        let first = |seed, purpose, stream| Noise::new(seed, purpose, stream).uniform();
        let all = [
            first(1, Purpose::Row, 0),
            first(2, Purpose::Row, 0),
            first(1, Purpose::Row, 1),
            first(1, Purpose::DeadPixels, 0),
            first(1, Purpose::RandomCamera, 0),
        ];
        for (index, value) in all.iter().enumerate() {
            assert!(all[index + 1..].iter().all(|other| other != value));
        }
    }
}
