//! How much a quantity scatters, depending on the amplitude: the dimmer, the noisier.

use crate::numerics::statistics::median;

/// Bins per factor of two in amplitude.
const BINS_PER_OCTAVE: f64 = 2.0;
/// Octaves that are told apart, from 2⁻⁸ DN on.
const OCTAVES: f64 = 40.0;
const LOWEST_OCTAVE: f64 = -8.0;
/// A bin with fewer values takes the figure of its nearest neighbour.
const LEAST_VALUES: usize = 40;

/// Median of a quantity for each bin of ln amplitude.
#[derive(Clone, Debug)]
pub(super) struct Scatter {
    bins: Vec<f64>,
}

impl Scatter {
    /// Of pairs of ln amplitude and quantity; `None` when no bin has enough of them.
    pub(super) fn measure(pairs: impl Iterator<Item = (f64, f64)>) -> Option<Self> {
        let mut values = vec![Vec::new(); (OCTAVES * BINS_PER_OCTAVE) as usize];
        for (ln_amplitude, value) in pairs.filter(|(_, value)| value.is_finite()) {
            values[bin(ln_amplitude)].push(value);
        }
        let found: Vec<Option<f64>> = values
            .iter_mut()
            .map(|values| if values.len() < LEAST_VALUES { None } else { median(values) })
            .collect();
        let nearest = |bin: usize| {
            let known = found.iter().enumerate().filter_map(|(at, value)| value.map(|value| (at, value)));
            known.min_by_key(|(at, _)| at.abs_diff(bin)).map(|(_, value)| value)
        };
        let bins: Option<Vec<f64>> = (0..found.len()).map(nearest).collect();
        bins.map(|bins| Self { bins })
    }

    /// The figure at one ln amplitude.
    pub(super) fn at(&self, ln_amplitude: f64) -> f64 {
        self.bins[bin(ln_amplitude)]
    }
}

/// Float casts saturate: amplitudes beyond the bins count with the outermost.
fn bin(ln_amplitude: f64) -> usize {
    let octaves = ln_amplitude * std::f64::consts::LOG2_E - LOWEST_OCTAVE;
    ((octaves * BINS_PER_OCTAVE) as usize).min((OCTAVES * BINS_PER_OCTAVE) as usize - 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_amplitude_has_the_figure_of_its_bin_or_of_the_nearest() {
        let pairs = (0..100).flat_map(|i| {
            let outlier = if i < 10 { 100.0 } else { 1.0 };
            [
                (100f64.ln(), outlier * 0.1),
                (1000f64.ln(), outlier * 0.02),
                (1e5f64.ln(), 7.0 / f64::from(i % 2)),
            ]
        });
        let scatter = Scatter::measure(pairs).unwrap();
        for (amplitude, expected) in
            [(100.0f64, 0.1), (1e-9, 0.1), (1000.0, 0.02), (3000.0, 0.02), (1e12, 7.0)]
        {
            assert_eq!(scatter.at(amplitude.ln()), expected, "{amplitude}");
        }
        assert!(Scatter::measure([(1.0, 1.0); 10].into_iter()).is_none());
    }
}
