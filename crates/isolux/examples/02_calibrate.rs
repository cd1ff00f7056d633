//! Calibrate a camera from two recordings: an exposure sweep and a distance sweep.
//!
//! - Exposure sweep: a still, bright wall, while the integration time grows step by step until the image saturates.
//! - Distance sweep: a flat board that faces the camera, at eight or more distances.
#![allow(clippy::print_stdout, reason = "an example shows its result")]

mod simulated;

use std::error::Error;

use isolux::calibrate::{CalibrateSettings, DistanceSweep, ExposureSweep, fit};

fn main() -> Result<(), Box<dyn Error>> {
    // The settings hold the reference conditions: the integration time and the distance at which amplitudes stay as
    // they are.
    let settings = CalibrateSettings::default();

    // 1. Measure. A sweep keeps a few numbers of each frame, so that a long recording need not fit in memory.
    let mut wall = ExposureSweep::new("wall", &settings);
    for frame in simulated::record("wall-sweep-smoke")? {
        wall.push(&frame)?;
    }
    let mut board = DistanceSweep::new("board", &settings);
    for frame in simulated::record("board-distances-smoke")? {
        board.push(&frame)?;
    }

    // 2. Fit every term that the two sweeps determine.
    let camera = Some("SR-3100, simulated".to_owned());
    let (calibration, report) = fit(&settings, camera, vec![wall.finish()], vec![board.finish()])?;

    // 3. Look at what was found. Each term says where it holds and how well it fits.
    if let Some(lut) = &calibration.terms.lut {
        let [from_us, to_us] = lut.valid_integration_time_us;
        println!("lut: {} integration times, {from_us} to {to_us} µs", lut.integration_time_us.len());
        println!("  relative residual {:.4}", lut.fit.residual);
    }
    if let Some(spline) = &calibration.terms.spline {
        let [from_m, to_m] = spline.law.valid_distance_m;
        println!("spline: {} points, {from_m:.2} to {to_m:.2} m", spline.fit.points);
        println!("  relative residual {:.4}", spline.fit.residual);
    }
    for tier in calibration.terms.response.iter().flat_map(|response| response.tiers()) {
        println!("response: tier {tier}");
    }
    if let Some(floor) = &calibration.noise_floor {
        println!("noise without light: {:.2} DN", floor.amplitude_sd_dn);
    }
    // Warnings say what to record better.
    for warning in &report.warnings {
        println!("warning: {warning}");
    }
    Ok(())
}
