use proptest::prelude::*;

use super::*;
use crate::terms::DistanceLaw;
use crate::terms::cubic::{Decay, DecayPoint, Scaling};

const FREQUENCY_HZ: f64 = 20e6;

/// A camera with a ring of lights of 5 cm radius and a harmonic.
fn response(d: f64) -> f64 {
    let ring = (1.0 + 0.0025 / (d * d)).powi(-2);
    ring / (d * d) * (1.0 + 0.02 * Harmonic::angle(FREQUENCY_HZ, d).cos())
}

/// Nearly normal numbers: twelve uniform ones from Knuth's MMIX generator.
struct Normal(u64);

impl Normal {
    fn next(&mut self) -> f64 {
        let mut uniform = || {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (self.0 >> 11) as f64 / (1u64 << 53) as f64
        };
        (0..12).map(|_| uniform()).sum::<f64>() - 6.0
    }
}

/// `count` positions evenly spread in ln d.
fn decay(level: f64, [from, to]: [f64; 2], count: u32, noise: f64, normal: &mut Normal) -> Decay {
    let distance = |i: u32| from * (to / from).powf(f64::from(i) / f64::from(count - 1));
    let mut point = |d: f64| DecayPoint {
        distance_m: d,
        amplitude_dn: level * response(d) * (noise * normal.next()).exp(),
    };
    Decay { integration_time_us: Some(level), points: (0..count).map(distance).map(&mut point).collect() }
}

fn four_decays(noise: f64) -> Vec<Decay> {
    let mut normal = Normal(3);
    [(100.0, [0.3, 2.0]), (400.0, [0.4, 3.0]), (900.0, [0.6, 4.0]), (4000.0, [1.1, 4.0])]
        .map(|(level, range)| decay(level, range, 22, noise, &mut normal))
        .into()
}

/// Largest and root mean square error of ln h over the valid range.
fn errors(spline: &Spline) -> (f64, f64) {
    let [min, max] = spline.law.valid_distance_m;
    let errors: Vec<f64> = (0..=300)
        .map(|i| min * (max / min).powf(f64::from(i) / 300.0))
        .map(|d| spline.ln_response(d) - (response(d) / response(0.75)).ln())
        .collect();
    let mean = errors.iter().map(|e| e * e).sum::<f64>() / errors.len() as f64;
    (errors.iter().fold(0.0, |largest, e| e.abs().max(largest)), mean.sqrt())
}

#[test]
fn a_known_law_is_recovered_within_noise() {
    const NOISE: f64 = 0.003;
    let decays = four_decays(NOISE);
    let (spline, uses) = Spline::fit(&decays, 0.75, Some(FREQUENCY_HZ)).unwrap();
    // 88 points, at most 20 degrees of freedom and the gauge: √(21/88) of the noise on average, four times that at
    // the ends, where a smooth curve has neighbours on one side only, and five standard errors of it.
    let (largest, average) = errors(&spline);
    assert!(average < NOISE * (21.0f64 / 88.0).sqrt() * 2.0, "{average:e}");
    assert!(largest < NOISE * (21.0f64 / 88.0).sqrt() * 5.0, "{largest:e}");
    let harmonic = spline.law.harmonic.unwrap();
    // Standard error of a coefficient of a cosine among 88 points: noise √(2/88), twice for the spline beside it.
    let error = 5.0 * 2.0 * NOISE * (2.0f64 / 88.0).sqrt();
    assert!((harmonic.cosine - 0.02).abs() < error && harmonic.sine.abs() < error, "{harmonic:?}");
    let scalings: Vec<_> = uses.iter().map(|used| used.scaling).collect();
    assert_eq!(
        scalings,
        [Scaling::AtReference, Scaling::AtReference, Scaling::AtReference, Scaling::OntoOthers]
    );
    // The residual is the noise: 88 points less some 20.
    assert!((0.7..1.2).contains(&(spline.fit.residual / NOISE)), "{}", spline.fit.residual);
    assert!((0.8..1.4).contains(&(spline.fit.held_out_residual.unwrap() / NOISE)), "{:?}", spline.fit);
    // A median of 22 has a standard error of a quarter.
    for used in uses {
        assert!((0.5..1.9).contains(&(used.held_out_error.unwrap() / NOISE)), "{used:?}");
    }
}

#[test]
fn without_the_frequency_the_spline_alone_follows() {
    let (spline, _) = Spline::fit(&four_decays(0.003), 0.75, None).unwrap();
    assert_eq!(spline.law.harmonic, None);
    assert!(errors(&spline).1 < 0.005, "{:?}", errors(&spline));
}

#[test]
fn a_camera_without_the_harmonic_gets_next_to_none() {
    let mut decays = four_decays(0.003);
    for point in decays.iter_mut().flat_map(|decay| &mut decay.points) {
        point.amplitude_dn /= 1.0 + 0.02 * Harmonic::angle(FREQUENCY_HZ, point.distance_m).cos();
    }
    let (spline, _) = Spline::fit(&decays, 0.75, Some(FREQUENCY_HZ)).unwrap();
    let found = spline.law.harmonic.map_or(0.0, |harmonic| harmonic.cosine.hypot(harmonic.sine));
    assert!(found < 10.0 * 0.003 * (2.0f64 / 88.0).sqrt(), "{found}");
}

#[test]
fn outliers_do_not_pull() {
    let clean = Spline::fit(&four_decays(0.003), 0.75, Some(FREQUENCY_HZ)).unwrap().0;
    let mut decays = four_decays(0.003);
    for (index, point) in decays.iter_mut().flat_map(|decay| &mut decay.points).enumerate() {
        if index % 11 == 4 {
            point.amplitude_dn *= if index % 2 == 0 { 0.5 } else { 3.0 };
        }
    }
    let (spoilt, uses) = Spline::fit(&decays, 0.75, Some(FREQUENCY_HZ)).unwrap();
    assert!(uses.iter().map(|used| used.outliers).sum::<usize>() >= 8);
    // An eleventh fewer points: the fit moves by a part of its own noise (see above).
    for i in 0..=100 {
        let d = 0.3 * (4.0f64 / 0.3).powf(f64::from(i) / 100.0);
        let moved = spoilt.ln_response(d) - clean.ln_response(d);
        assert!(moved.abs() < 0.003 * (21.0f64 / 88.0).sqrt() * 5.0, "{d} m: {moved:e}");
    }
}

#[test]
fn a_decay_far_from_the_reference_is_placed_by_its_level_and_one_without_overlap_left_out() {
    let mut normal = Normal(8);
    let decays = [
        decay(10.0, [0.3, 2.0], 12, 0.0, &mut normal),
        decay(7000.0, [1.5, 4.0], 12, 0.0, &mut normal),
        decay(9000.0, [6.0, 9.0], 12, 0.0, &mut normal),
    ];
    let (spline, uses) = Spline::fit(&decays, 0.75, Some(FREQUENCY_HZ)).unwrap();
    let scalings: Vec<_> = uses.iter().map(|used| used.scaling).collect();
    assert_eq!(scalings, [Scaling::AtReference, Scaling::OntoOthers, Scaling::LeftOut]);
    assert_eq!(spline.law.valid_distance_m, [0.3, 4.0]);
    // Without noise, what is left is what 24 intervals and the exp(cos) of the harmonic, h₃²/4, leave: 1e-4; the
    // overlap of a few positions carries it on.
    assert!(errors(&spline).0 < 2e-3, "{:?}", errors(&spline));
    assert_eq!(uses[2].residual, None);
}

#[test]
fn outside_its_range_it_goes_on_as_the_square_and_the_table_says_the_same() {
    let (spline, _) = Spline::fit(&four_decays(0.003), 0.75, Some(FREQUENCY_HZ)).unwrap();
    for (outside, edge) in [(0.1, 0.3), (12.0, 4.0f64)] {
        let slope = (spline.multiplier(outside) / spline.multiplier(edge)).ln() / (outside / edge).ln();
        assert!((slope - 2.0).abs() < 1e-12, "{slope}");
    }
    let DistanceLaw { polynomial: square, table: Some(table) } = spline.law.distance_law() else {
        panic!("a spline has a table")
    };
    for i in 0..=50_000 {
        let d = 0.05 * 400f64.powf(f64::from(i) / 5e4);
        let d = f64::from(d as f32);
        let fast = f64::from(square.at(d as f32) * table.at(d as f32));
        assert!((fast / spline.multiplier(d) - 1.0).abs() < 1e-5, "{d} m");
    }
    assert!(table.cells() < 1000, "{} cells do not stay in the first-level cache", table.cells());
}

#[test]
fn what_cannot_be_fitted_is_refused_with_the_reason() {
    let mut normal = Normal(1);
    let few = decay(1.0, [0.5, 2.0], 7, 0.0, &mut normal);
    assert_eq!(Spline::fit(&[few], 0.75, None).unwrap_err(), SplineError::TooFewPositions { found: 7 });
    let far = decay(1.0, [1.0, 2.0], 9, 0.0, &mut normal);
    assert_eq!(
        Spline::fit(&[far], 0.75, None).unwrap_err(),
        SplineError::ReferenceOutside { reference_m: 0.75 }
    );
    let mut dark = decay(1.0, [0.5, 2.0], 9, 0.0, &mut normal);
    dark.points[3].amplitude_dn = 0.0;
    assert_eq!(Spline::fit(&[dark], 0.75, None).unwrap_err(), SplineError::TooFewPositions { found: 0 });
    assert_eq!(Spline::fit(&[], 0.75, None).unwrap_err(), SplineError::TooFewPositions { found: 0 });
}

#[test]
fn edited_parameters_are_checked() {
    let (good, _) = Spline::fit(&four_decays(0.003), 0.75, Some(FREQUENCY_HZ)).unwrap();
    assert!(good.check().is_ok());
    let spoil = |change: fn(&mut Spline)| {
        let mut spline = good.clone();
        change(&mut spline);
        spline.check().unwrap_err().field
    };
    assert_eq!(spoil(|s| s.version = 2), "spline.version");
    assert_eq!(spoil(|s| s.law.valid_distance_m = [1.0, 1.0]), "spline.valid_distance_m");
    assert_eq!(spoil(|s| s.law.valid_distance_m = [0.0, 1.0]), "spline.valid_distance_m");
    assert_eq!(spoil(|s| s.law.reference_distance_m = 9.0), "spline.reference_distance_m");
    assert_eq!(spoil(|s| s.law.coefficients.truncate(3)), "spline.coefficients");
    assert_eq!(spoil(|s| s.law.coefficients[5] = f64::NAN), "spline.coefficients");
    assert_eq!(spoil(|s| s.law.coefficients[5] = 900.0), "spline.coefficients");
    assert_eq!(spoil(|s| s.law.curvature_weight = -1.0), "spline.curvature_weight");
    let harmonic =
        |modulation_frequency_hz, sine| Some(Harmonic { modulation_frequency_hz, cosine: 0.0, sine });
    let spoil_harmonic = |harmonic| {
        Spline { law: Law { harmonic, ..good.law.clone() }, ..good.clone() }.check().unwrap_err().field
    };
    assert_eq!(spoil_harmonic(harmonic(FREQUENCY_HZ, 0.7)), "spline.harmonic");
    assert_eq!(spoil_harmonic(harmonic(1e12, 0.0)), "spline.harmonic.modulation_frequency_hz");
    assert_eq!(spoil_harmonic(harmonic(FREQUENCY_HZ, f64::NAN)), "spline.harmonic");
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, failure_persistence: None, ..ProptestConfig::default() })]

    /// Levels are nuisances: the fit does not depend on the targets' brightness, nor on a table over time, which
    /// multiplies each decay by one number. It is 1 at any reference, and another reference is another gauge.
    #[test]
    fn the_fit_depends_on_no_scale(
        factors in prop::array::uniform4(1e-3..1e3f64), reference_m in 0.4..2.0f64, seed in 1u64..1000,
    ) {
        let mut normal = Normal(seed);
        let ranges = [[0.3, 2.0], [0.35, 3.0], [0.38, 4.0], [1.1, 4.0]];
        let decays: Vec<_> = ranges.map(|range| decay(100.0, range, 16, 0.003, &mut normal)).into();
        let mut scaled = decays.clone();
        for (decay, factor) in scaled.iter_mut().zip(factors) {
            decay.points.iter_mut().for_each(|point| point.amplitude_dn *= factor);
        }
        let (one, _) = Spline::fit(&decays, reference_m, Some(FREQUENCY_HZ)).unwrap();
        let (other, _) = Spline::fit(&scaled, reference_m, Some(FREQUENCY_HZ)).unwrap();
        let (elsewhere, _) = Spline::fit(&decays, 0.75, Some(FREQUENCY_HZ)).unwrap();
        prop_assert!(one.ln_response(reference_m).abs() < 1e-12);
        for i in 0..=40 {
            let d = 0.2 * 40f64.powf(f64::from(i) / 40.0);
            // Rounding 1e-16 of logarithms up to 10, times the condition of the normal equations, 1e6.
            prop_assert!((one.ln_response(d) - other.ln_response(d)).abs() < 1e-8);
            let gauge = elsewhere.ln_response(d) - elsewhere.ln_response(reference_m);
            prop_assert!((one.ln_response(d) - gauge).abs() < 1e-8);
        }
    }
}
