//! Noise estimated from differences between neighbours in space or time.

/// Share of the largest differences left out, so that edges and movement do not count as noise.
const TRIMMED_SHARE: f64 = 0.05;
/// Variance of a standard normal whose outer 5 % are cut off at z = 1.960:
/// `1 − 2 z φ(z) / 0.95`, φ(1.960) = 0.058445.
const TRIMMED_VARIANCE: f64 = 0.758_8;
/// Fewer differences than this make no estimate.
const LEAST_DIFFERENCES: usize = 16;

/// Distances that scatter by more than this share of themselves are not to be trusted: noise that strong wraps around
/// the ambiguity range and shifts means, and an over-saturated or dark window has no distance at all.
pub(crate) const DISTANCE_NOISE_SHARE: f64 = 0.1;

/// Standard deviation of normal `differences` from the smaller 95 % of them; `None` when they are too few.
/// Unlike the median deviation, it does not collapse to 0 or to one step on coarsely quantized images.
pub(crate) fn trimmed_deviation(differences: &mut [f64]) -> Option<f64> {
    if differences.len() < LEAST_DIFFERENCES {
        return None;
    }
    differences.sort_by(|a, b| a.abs().total_cmp(&b.abs()));
    let kept = &differences[..(differences.len() as f64 * (1.0 - TRIMMED_SHARE)) as usize];
    let mean_square = kept.iter().map(|d| d * d).sum::<f64>() / kept.len() as f64;
    Some((mean_square / TRIMMED_VARIANCE).sqrt())
}

/// Noise of one image region from second differences along its rows: they cancel any linear gradient, and their
/// variance is 6 σ². `rows` hold NaN where a pixel is invalid.
pub(crate) fn spatial<'a>(rows: impl Iterator<Item = &'a [f64]>) -> Option<f64> {
    let mut differences = Vec::new();
    for row in rows {
        let second = row.windows(3).map(|w| w[0] - 2.0 * w[1] + w[2]);
        differences.extend(second.filter(|difference| difference.is_finite()));
    }
    trimmed_deviation(&mut differences).map(|deviation| deviation / 6f64.sqrt())
}

/// Noise of one image from the difference to another of the same still scene (variance 2 σ²).
/// Values are paired; NaN where a pixel is invalid.
pub(crate) fn temporal(first: &[f64], second: &[f64]) -> Option<f64> {
    let pairs = first.iter().zip(second).map(|(a, b)| a - b);
    let mut differences: Vec<f64> = pairs.filter(|difference| difference.is_finite()).collect();
    trimmed_deviation(&mut differences).map(|deviation| deviation / 2f64.sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Normal deviates of σ = 1 at evenly spaced probabilities would need the inverse error function; sums of
    /// twelve uniforms (variance 1) are close enough for a 5 % check. Constants: Knuth's MMIX generator.
    fn normal(count: usize) -> Vec<f64> {
        let mut state = 1u64;
        let mut uniform = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1u64 << 53) as f64
        };
        (0..count).map(|_| (0..12).map(|_| uniform()).sum::<f64>() - 6.0).collect()
    }

    #[test]
    fn recovers_sigma_in_space_and_time() {
        // 4000 differences: standard error of a deviation 1/√(2·4000) = 1.1 %, doubled by the overlap of second
        // differences; 5 % is more than two of these.
        let noise = normal(4000);
        let tilted: Vec<f64> = noise.iter().enumerate().map(|(i, n)| 3.0 * n + 0.7 * i as f64).collect();
        let found = spatial(tilted.chunks(40)).unwrap();
        assert!((found / 3.0 - 1.0).abs() < 0.05, "{found}");
        let (first, second) = noise.split_at(2000);
        let found = temporal(first, second).unwrap();
        assert!((found - 1.0).abs() < 0.05, "{found}");
    }

    #[test]
    fn edges_invalid_pixels_and_too_little_data() {
        let mut noise = normal(1000);
        for spoilt in noise.iter_mut().step_by(100) {
            *spoilt = f64::NAN;
        }
        noise[55] = 1e9;
        let found = spatial(noise.chunks(1000)).unwrap();
        assert!((found - 1.0).abs() < 0.1, "{found}");
        assert_eq!(spatial([1.0, 2.0, 3.0].chunks(3)), None);
    }
}
