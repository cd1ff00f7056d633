//! The response beside the paper's table, on unseen cameras and exposures. The figures:
//! `cargo test --release -p isolux-experiments --test response -- --nocapture`.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "tests fail by panicking")]
#![allow(clippy::print_stdout, reason = "the figures are read off this test")]

use isolux_experiments::unseen::response::{FittedOn, Light, ResponseFigure, measure};

fn figures(cameras: &[u64], light: Light, fitted_on: FittedOn) -> Vec<ResponseFigure> {
    let figures: Vec<ResponseFigure> =
        cameras.iter().flat_map(|&camera| measure(camera, light, fitted_on).unwrap()).collect();
    for f in &figures {
        let percent = [f.median_cv, f.p95_cv, f.lut_median_cv, f.floor_median_cv].map(|v| 100.0 * v);
        println!(
            "camera {} {light:?} by {fitted_on:?}, {:>13}: median {:5.2} %, p95 {:5.2} %, lut there {:5.2} %, \
             noise {:5.2} %, valid {:5.1} %",
            f.camera,
            f.method,
            percent[0],
            percent[1],
            percent[2],
            percent[3],
            100.0 * f.valid_fraction
        );
    }
    figures
}

fn of<'a>(figures: &'a [ResponseFigure], methods: &'a [&str]) -> impl Iterator<Item = &'a ResponseFigure> {
    figures.iter().filter(move |figure| methods.contains(&figure.method))
}

/// The aim: at least three times lower than a table refitted on the same scene, on the same pixels. And the
/// bins and the DC image leave nothing but noise: 3 % of it, since the medians rest on 3000 pixels of 16 exposures
/// (1/√(2·16·3000) = 0.3 % by themselves).
#[test]
fn strong_ambient_light_is_taken_out_where_a_table_refitted_on_the_scene_fails() {
    let figures = figures(&[201, 202, 203, 204], Light::StrongAmbient, FittedOn::Scene);
    assert_eq!(of(&figures, &["pixel", "intensity", "phase_samples"]).count(), 12);
    for figure in of(&figures, &["pixel", "intensity", "phase_samples"]) {
        assert!(figure.lut_median_cv >= 3.0 * figure.median_cv, "{figure:?}");
        assert!(figure.valid_fraction >= 0.9, "{figure:?}");
    }
    for figure in of(&figures, &["intensity", "phase_samples"]) {
        assert!(figure.median_cv <= 1.03 * figure.floor_median_cv, "{figure:?}");
    }
}

/// A wall in the laboratory is enough for the tiers that measure the fill.
#[test]
fn the_fill_holds_for_scenes_that_were_not_calibrated() {
    for light in [Light::Dark, Light::StrongAmbient] {
        let figures = figures(&[205, 206], light, FittedOn::Wall);
        assert_eq!(of(&figures, &["pixel"]).count(), 0);
        assert_eq!(of(&figures, &["intensity", "phase_samples"]).count(), 4);
        for figure in of(&figures, &["intensity", "phase_samples"]) {
            assert!(figure.median_cv < 0.7 * figure.lut_median_cv, "{figure:?}");
            assert!(figure.valid_fraction >= 0.95, "{figure:?}");
        }
    }
}

#[test]
fn without_ambient_light_every_tier_but_the_scalar_is_better_than_the_table() {
    let figures = figures(&[207, 208], Light::Dark, FittedOn::Scene);
    for figure in of(&figures, &["amplitude", "pixel", "intensity", "phase_samples"]) {
        assert!(figure.median_cv < 0.5 * figure.lut_median_cv, "{figure:?}");
        assert!(figure.valid_fraction >= 0.9, "{figure:?}");
    }
    for figure in of(&figures, &["scalar"]) {
        assert!((figure.median_cv / figure.lut_median_cv - 1.0).abs() < 0.1, "{figure:?}");
    }
}
