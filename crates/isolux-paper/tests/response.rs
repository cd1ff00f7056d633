//! The response beside the paper's table, on unseen cameras. The figures:
//! `cargo test --release -p isolux-paper --test response -- --nocapture`.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "tests fail by panicking")]

use isolux_paper::beyond::response::{FittedOn, Light, ResponseFigure, measure};

const CAMERAS: [u64; 4] = [201, 202, 203, 204];

fn figures(light: Light, fitted_on: FittedOn) -> Vec<ResponseFigure> {
    let figures: Vec<ResponseFigure> =
        CAMERAS.iter().flat_map(|&camera| measure(camera, light, fitted_on).unwrap()).collect();
    for f in &figures {
        println!(
            "{} {light:?} {fitted_on:?} {:>13}: median {:6.2} %, p95 {:6.2} %, valid {:5.1} %, lut there {:6.2} %, floor {:5.2} %",
            f.camera, f.method, 100.0 * f.median_cv, 100.0 * f.p95_cv, 100.0 * f.valid_fraction,
            100.0 * f.lut_median_cv, 100.0 * f.floor_median_cv
        );
    }
    figures
}

#[test]
fn show() {
    for light in [Light::Dark, Light::StrongAmbient] {
        for fitted_on in [FittedOn::Scene, FittedOn::Wall] {
            figures(light, fitted_on);
        }
    }
}
