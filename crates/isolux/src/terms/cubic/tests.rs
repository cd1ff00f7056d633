//! Decays of known laws: does the cubic come back?

use super::*;
use crate::terms::polynomial::evaluate;

/// Decay of an exact d² camera with an amplitude of `scale` at 1 m.
fn decay(time: f64, scale: f64, distances: impl IntoIterator<Item = f64>) -> Decay {
    let point = |d: f64| DecayPoint { distance_m: d, amplitude_dn: scale / (d * d) };
    Decay { integration_time_us: Some(time), points: distances.into_iter().map(point).collect() }
}

fn steps(from: f64, to: f64, count: u32) -> impl Iterator<Item = f64> {
    (0..count).map(move |i| from + (to - from) * f64::from(i) / f64::from(count - 1))
}

#[test]
fn a_square_law_camera_gives_the_square() {
    let decays = [decay(1000.0, 700.0, steps(0.5, 3.0, 11)), decay(4000.0, 2800.0, steps(0.7, 3.0, 9))];
    let (cubic, uses) = Cubic::fit(&decays, 0.75).unwrap();
    let [c0, c1, c2, c3] = cubic.coefficients;
    assert!(c0.abs() < 1e-9 && c1.abs() < 1e-9 && (c2 - 1.0 / 0.5625).abs() < 1e-9 && c3.abs() < 1e-9);
    assert_eq!(cubic.valid_distance_m, [0.5, 3.0]);
    assert!(cubic.fit.residual < 1e-12);
    assert!(uses.iter().all(|used| used.scaling == Scaling::AtReference));
    assert!(cubic.check().is_ok());
}

#[test]
fn a_decay_that_does_not_reach_the_reference_is_scaled_on_and_not_extrapolated() {
    let decays = [
        decay(1000.0, 700.0, steps(0.5, 2.0, 9)),
        decay(9000.0, 5000.0, steps(1.5, 3.5, 9)),
        decay(9500.0, 5000.0, steps(3.0, 5.0, 9)),
        decay(9900.0, 5000.0, steps(8.0, 9.0, 9)),
    ];
    let (cubic, uses) = Cubic::fit(&decays, 0.75).unwrap();
    let scalings: Vec<_> = uses.iter().map(|used| used.scaling).collect();
    assert_eq!(scalings, [Scaling::AtReference, Scaling::OntoOthers, Scaling::OntoOthers, Scaling::LeftOut]);
    assert_eq!(cubic.valid_distance_m, [0.5, 5.0]);
    assert!((evaluate(cubic.coefficients, 4.0) - 16.0 / 0.5625).abs() < 1e-6);
    assert_eq!(uses[3].residual, None);
}

#[test]
fn what_cannot_be_fitted_is_refused_with_the_reason() {
    let far = Cubic::fit(&[decay(1.0, 1.0, steps(1.0, 3.0, 9))], 0.75).unwrap_err();
    assert!(matches!(far, CubicError::ReferenceOutside { .. }), "{far}");
    let few = Cubic::fit(&[decay(1.0, 1.0, [0.5, 1.0, 2.0])], 0.75).unwrap_err();
    assert_eq!(few, CubicError::TooFewDistances { found: 3 });
    assert_eq!(Cubic::fit(&[], 0.75).unwrap_err(), CubicError::TooFewDistances { found: 0 });
}

#[test]
fn a_cubic_that_dips_below_zero_is_refused_when_read() {
    let (mut cubic, _) = Cubic::fit(&[decay(1.0, 1.0, steps(0.5, 3.0, 9))], 0.75).unwrap();
    cubic.coefficients = [1.0, -1.0, 0.0, 0.0];
    assert_eq!(cubic.check().unwrap_err().field, "cubic.coefficients");
    cubic.valid_distance_m = [3.0, 0.5];
    assert_eq!(cubic.check().unwrap_err().field, "cubic.valid_distance_m");
}
