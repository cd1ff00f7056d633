//! `sigma`: the cutoff is the mean plus k population standard deviations of the valid pixels.

/// Parameters of the sigma rule.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SigmaRule {
    /// k, 4 in the paper.
    pub deviations: f64,
}

impl Default for SigmaRule {
    fn default() -> Self {
        Self { deviations: 4.0 }
    }
}

impl SigmaRule {
    pub(super) fn cutoff(&self, values: &[f32]) -> Option<f32> {
        let valid = || values.iter().map(|&v| f64::from(v)).filter(|v| *v > 0.0 && v.is_finite());
        let (count, sum) = valid().fold((0.0, 0.0), |(count, sum), v| (count + 1.0, sum + v));
        if count == 0.0 {
            return None;
        }
        let mean = sum / count;
        let variance = valid().map(|v| (v - mean) * (v - mean)).sum::<f64>() / count;
        Some((mean + self.deviations * variance.sqrt()) as f32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn uses_the_population_deviation_of_valid_pixels() {
        // Mean 3, population σ 1 (sample σ would be 1.15).
        let cutoff = SigmaRule { deviations: 2.0 }.cutoff(&[2.0, 4.0, f32::NAN, 2.0, 4.0, 0.0]);
        assert_eq!(cutoff, Some(5.0));
        assert_eq!(SigmaRule::default().cutoff(&[f32::NAN]), None);
    }
}
