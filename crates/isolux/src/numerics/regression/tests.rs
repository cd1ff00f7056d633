//! The regression against closed forms and made-up truths.

use super::*;
use crate::numerics::robust::Loss;

/// Uniform pseudo-random numbers in −1..1: a linear congruential generator (Knuth's MMIX constants).
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
}

fn push(regression: &mut Regression, columns: &[f64], response: f64, group: u32, clusters: &[u32]) {
    regression.push(Row { columns, response, weight: 1.0, group, clusters }).unwrap();
}

#[test]
fn least_squares_is_the_textbook_line() {
    // NumPy: polyfit([0, 1, 2, 4], [1, 3, 2, 7], 1) = 1.4 x + 0.8.
    let mut regression = Regression::new(["x"], Intercepts::PerGroup);
    for (x, y) in [(0.0, 1.0), (1.0, 3.0), (2.0, 2.0), (4.0, 7.0)] {
        push(&mut regression, &[x], y, 0, &[]);
    }
    let fit = regression.fit(Loss::LeastSquares).unwrap();
    assert!((fit.coefficients[0].value - 1.4).abs() < 1e-14);
    // White's HC standard error with G/(G−1): √(4/3 Σ x²r²)/Σx², x centred.
    let (x, y): ([f64; 4], [f64; 4]) = ([-1.75, -0.75, 0.25, 2.25], [1.0, 3.0, 2.0, 7.0]);
    let residual = |i: usize| y[i] - 3.25 - 1.4 * x[i];
    let meat: f64 = (0..4).map(|i| (x[i] * residual(i)).powi(2)).sum();
    let expected = (4.0 / 3.0 * meat).sqrt() / x.iter().map(|x| x * x).sum::<f64>();
    assert!((fit.coefficients[0].standard_error - expected).abs() < 1e-14);
}

#[test]
fn truth_is_recovered_with_outliers_and_a_thousand_intercepts() {
    let mut numbers = Numbers(1);
    let mut regression = Regression::new(["t", "d"], Intercepts::PerGroup);
    for group in 0..1000 {
        let intercept = 10.0 * numbers.next();
        for step in 0..5 {
            let (t, d) = (f64::from(step), numbers.next());
            let gross = if (group + step) % 10 == 0 { 8.0 } else { 0.0 };
            let noise = 0.1 * (numbers.next() + numbers.next());
            push(&mut regression, &[t, d], intercept + 0.7 * t - 2.0 * d + noise + gross, group as u32, &[]);
        }
    }
    let fit = regression.fit(Loss::Tukey).unwrap();
    for (coefficient, truth) in fit.coefficients.iter().zip([0.7, -2.0]) {
        // Five standard errors.
        assert!((coefficient.value - truth).abs() < 5.0 * coefficient.standard_error, "{coefficient:?}");
        assert!(coefficient.standard_error < 0.004, "{coefficient:?}");
    }
    // σ of the sum of two uniforms of ±0.1 is 0.0816; outliers and small groups move the MAD by some per cent.
    assert!((fit.residual_sigma / 0.0816 - 1.0).abs() < 0.2, "{}", fit.residual_sigma);
    assert!((fit.kept_fraction - 0.9).abs() < 0.01, "{}", fit.kept_fraction);
}

/// Errors shared by 50 rows each: intervals that ignore it would hold the truth in a third of the cases.
#[test]
fn intervals_cover_when_errors_are_shared() {
    let mut covered = 0;
    for seed in 0..200 {
        let mut numbers = Numbers(seed);
        let mut regression = Regression::new(["x"], Intercepts::PerGroup);
        for cluster in 0..40 {
            let (x, shared) = (numbers.next(), numbers.next());
            for _ in 0..50 {
                push(&mut regression, &[x], 1.5 * x + shared + 0.1 * numbers.next(), 0, &[cluster]);
            }
        }
        let line = &regression.fit(Loss::LeastSquares).unwrap().coefficients[0];
        covered += usize::from(line.low_95 <= 1.5 && 1.5 <= line.high_95);
    }
    // 190 expected; σ = √(200·0.95·0.05) = 3; sandwich errors are known to be some per cent small with 40 clusters.
    assert!((176..=200).contains(&covered), "{covered}");
}

#[test]
fn what_cannot_be_determined_is_named() {
    let mut regression = Regression::new(["t", "d"], Intercepts::PerGroup);
    for row in 0..20 {
        push(&mut regression, &[f64::from(row), 3.0 * f64::from(row) + 1.0], f64::from(row), 0, &[]);
    }
    let error = regression.fit(Loss::Tukey).unwrap_err();
    assert_eq!(error, RegressionError::Dependent { column: "d".into(), others: vec!["`t`".into()] });
    let mut regression = Regression::new(["t", "d"], Intercepts::PerGroup);
    for row in 0..20u32 {
        push(&mut regression, &[f64::from(row % 2), f64::from(row)], f64::from(row % 3), row % 2, &[]);
    }
    assert_eq!(regression.fit(Loss::Tukey).unwrap_err(), RegressionError::Constant { column: "t".into() });
}

#[test]
fn too_little_is_refused() {
    let mut regression = Regression::new(["x"], Intercepts::PerGroup);
    assert!(matches!(regression.fit(Loss::Tukey), Err(RegressionError::TooFewRows { found: 0, .. })));
    let bad = Row { columns: &[f64::NAN], response: 1.0, weight: 1.0, group: 0, clusters: &[] };
    assert_eq!(regression.push(bad), Err(RegressionError::Row { row: 0, columns: 1 }));
    for row in 0..30u32 {
        push(&mut regression, &[f64::from(row)], f64::from(row), 0, &[row % 2]);
    }
    assert_eq!(regression.fit(Loss::Tukey), Err(RegressionError::TooFewClusters { found: 2, needed: 3 }));
}

#[test]
fn an_exact_relation_has_no_residual() {
    let mut regression = Regression::new(["x"], Intercepts::PerGroup);
    (0..30).for_each(|row| push(&mut regression, &[f64::from(row)], 2.0 * f64::from(row) + 7.0, 0, &[]));
    let fit = regression.fit(Loss::Tukey).unwrap();
    assert!((fit.coefficients[0].value - 2.0).abs() < 1e-12 && fit.residual_sigma < 1e-9);
}
