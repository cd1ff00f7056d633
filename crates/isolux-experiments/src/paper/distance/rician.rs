//! The mean of an amplitude that noise has been added to: an amplitude is a length, so noise only lengthens it.

/// Beyond this ratio a²/2σ² the expansion replaces the series, which would overflow; its error is 1e-5 there.
const SERIES_UP_TO: f64 = 50.0;

/// Mean of the Rician law, in the unit of its arguments: `σ √(π/2) L½(−a²/2σ²)` (Rice 1945; methods, section 1).
/// Without signal it is the floor `√(π/2) σ`, with a strong one `a + σ²/2a`.
pub(super) fn mean(amplitude: f64, sigma: f64) -> f64 {
    let x = 0.5 * (amplitude / sigma).powi(2);
    if x > SERIES_UP_TO {
        return amplitude * (1.0 + 1.0 / (4.0 * x) + 1.0 / (32.0 * x * x));
    }
    sigma * std::f64::consts::FRAC_PI_2.sqrt() * (-x).exp() * kummer(x)
}

/// Kummer's `₁F₁(3/2; 1; x)` for x ≥ 0, by its series of positive terms; `L½(−x) = e⁻ˣ ₁F₁(3/2; 1; x)`.
fn kummer(x: f64) -> f64 {
    let (mut sum, mut term, mut n) = (1.0, 1.0, 0.0);
    while term > 1e-16 * sum {
        term *= (1.5 + n) * x / ((1.0 + n) * (1.0 + n));
        sum += term;
        n += 1.0;
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limits_and_a_tabulated_value() {
        assert!((mean(0.0, 2.0) - 2.0 * 1.253_314_137_315_5).abs() < 1e-12);
        // σ = a = 1: √(π/2) e^(−1/4) ((3/2) I0(1/4) + (1/2) I1(1/4)), with I0 = 1.015686141, I1 = 0.125979109.
        let expected = 1.253_314_137_3 * (-0.25f64).exp() * (1.5 * 1.015_686_141 + 0.5 * 0.125_979_109);
        assert!((mean(1.0, 1.0) - expected).abs() < 1e-8, "{}", mean(1.0, 1.0));
        assert!((mean(1000.0, 1.0) - 1000.0005).abs() < 1e-9);
    }

    #[test]
    fn series_and_expansion_meet() {
        let at = |x: f64| mean((2.0 * x).sqrt(), 1.0) / (2.0 * x).sqrt();
        // Third term of the expansion: 3 / (128 x³), 2e-7 there; the slope over 2e-6 of x is far below.
        assert!((at(SERIES_UP_TO * (1.0 + 1e-6)) - at(SERIES_UP_TO)).abs() < 5e-7);
    }
}
