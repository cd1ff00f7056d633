//! Standardize a live camera: frames arrive one by one, and automatic exposure changes the integration time.
#![allow(clippy::print_stdout, reason = "an example shows its result")]

mod simulated;

use std::error::Error;
use std::sync::mpsc;
use std::thread;

use isolux::standardize::DenoiseStep;
use isolux::{Channels, Choice, DenoiseRule, Plane, Standardizer};

fn main() -> Result<(), Box<dyn Error>> {
    // Plan before the first frame arrives. The distance is averaged over the last frames before it scales the
    // amplitude; the stream remembers them.
    let choice = Choice { denoise: Some(DenoiseStep::Smooth(DenoiseRule::Temporal)), ..Choice::default() };
    let calibration = simulated::calibration()?;
    let channels =
        Channels::AMPLITUDE | Channels::INTENSITY | Channels::DISTANCE | Channels::INTEGRATION_TIME;
    let mut stream = Standardizer::plan(&choice, Some(&calibration), channels)?.stream();

    // The camera: a thread that delivers a desk at 2 to 16.2 ms.
    let recorded = simulated::record("office-desk")?;
    let (camera, frames) = mpsc::sync_channel(2);
    let camera = thread::spawn(move || {
        recorded.into_iter().skip(9).take(27).try_for_each(|frame| camera.send(frame).ok())
    });

    // The loop: nothing is allocated for a frame after the first one.
    println!("{:>8} {:>12} {:>15}", "µs", "raw DN", "standardized DN");
    for frame in frames {
        let out = stream.push(&frame)?;
        let time_us = frame.integration_time_us.at(0).unwrap_or(f64::NAN);
        println!("{time_us:>8} {:>12.1} {:>15.1}", wall(&frame.amplitude), wall(&out.amplitude));
    }
    let _ = camera.join();

    // Another scene: what was remembered of the old one must not leak into it.
    stream.reset();
    Ok(())
}

/// Mean over a part of the back wall.
fn wall(image: &Plane<f32>) -> f32 {
    let pixels = (10..26).flat_map(|row| (112..128).filter_map(move |column| image.get(row, column)));
    let (sum, count) = pixels.filter(|value| value.is_finite()).fold((0.0, 0), |(s, n), v| (s + v, n + 1));
    sum / count as f32
}
