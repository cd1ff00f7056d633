//! Curves of known cameras: does the table say what they do?

use super::*;

fn samples(curve: impl Fn(f64) -> f64, times: &[f64]) -> Vec<ExposureSample> {
    let sample =
        |&t: &f64| ExposureSample { integration_time_us: t, mean_amplitude_dn: curve(t), frame_spread: 0.0 };
    times.iter().map(sample).collect()
}

#[test]
fn a_linear_camera_gives_the_linear_law_between_samples_too() {
    let lut = Lut::fit(&samples(|t| 0.3 * t, &[200.0, 1400.0, 8200.0, 20000.0]), 8200.0).unwrap();
    for time in [200.0, 1000.0, 8200.0, 15000.0] {
        let LutAnswer::Inside(multiplier) = lut.at(time) else { panic!("{time}") };
        assert!((multiplier / crate::terms::linear::multiplier(time, 8200.0) - 1.0).abs() < 1e-12);
    }
    assert_eq!(lut.fit.held_out_residual.map(|r| r < 1e-12), Some(true));
}

#[test]
fn the_table_ends_at_the_peak_and_continues_as_one_over_t_below() {
    let curve = |t: f64| t * (-t / 20000.0).exp();
    let times: Vec<f64> = (1..=50).map(|i| f64::from(i) * 1000.0).collect();
    let lut = Lut::fit(&samples(curve, &times), 8200.0).unwrap();
    assert_eq!(lut.valid_integration_time_us, [1000.0, 20000.0]);
    assert_eq!(lut.at(20000.1), LutAnswer::Refused);
    let (LutAnswer::Inside(edge), LutAnswer::Below(half)) = (lut.at(1000.0), lut.at(500.0)) else { panic!() };
    assert!((half / edge - 2.0).abs() < 1e-12);
    assert!(lut.check().is_ok());
}

#[test]
fn the_reference_must_lie_in_the_sweep() {
    let error = Lut::fit(&samples(|t| t, &[200.0, 400.0]), 8200.0).unwrap_err();
    assert_eq!(error, LutError::ReferenceOutside { reference_us: 8200.0, min_us: 200.0, max_us: 400.0 });
    assert_eq!(Lut::fit(&[], 8200.0).unwrap_err(), LutError::TooFewTimes { found: 0 });
    let dark = Lut::fit(&samples(|_| 0.0, &[200.0, 400.0]), 300.0).unwrap_err();
    assert!(matches!(dark, LutError::NoSignal { .. }));
}

#[test]
fn edited_tables_are_checked() {
    let good = Lut::fit(&samples(|t| t, &[200.0, 400.0, 800.0]), 400.0).unwrap();
    let spoil = |change: fn(&mut Lut)| {
        let mut lut = good.clone();
        change(&mut lut);
        lut.check().unwrap_err().field
    };
    assert_eq!(spoil(|l| l.version = 2), "lut.version");
    assert_eq!(spoil(|l| l.multiplier.truncate(1)), "lut.multiplier");
    assert_eq!(spoil(|l| l.multiplier[1] = -1.0), "lut.multiplier");
    assert_eq!(spoil(|l| l.integration_time_us[1] = f64::NAN), "lut.integration_time_us");
    assert_eq!(spoil(|l| l.integration_time_us.clear()), "lut.integration_time_us");
    assert_eq!(spoil(|l| l.valid_integration_time_us = [200.0, 900.0]), "lut.valid_integration_time_us");
}
